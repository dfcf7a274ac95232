// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "ablate/comparison.h"

#include <algorithm>
#include <cmath>

#include "ablate/statistics.h"
#include "util/errors.h"

namespace facet {
namespace {

bool Close(double a, double b) {
  return a == b || std::abs(a - b) <= 1e-6 * std::max(std::abs(a), std::abs(b));
}

std::string Describe(const RunResult& run) {
  return std::to_string(static_cast<long long>(run.Get("texels"))) +
         " texels, " +
         std::to_string(static_cast<long long>(run.Get("observations"))) +
         " observations, fingerprint " + run.fingerprint;
}

bool Finished(const RunResult& run) { return run.problem.empty(); }

}  // namespace

void CheckSameObservations(const AblationPlan& plan,
                           const RunResult& run,
                           const std::vector<RunResult>& others) {
  for (const RunResult& other : others) {
    if (!Finished(other) || other.scan != run.scan ||
        other.fingerprint == run.fingerprint) {
      continue;
    }
    throw OptionsError(
        "the runs '" + plan.variants[other.variant].label + "' (" +
        Describe(other) + ") and '" + plan.variants[run.variant].label + "' (" +
        Describe(run) + ") of " + plan.scans[run.scan].spec.name +
        " have other texels or observations, so their energies cannot be "
        "compared: vary other flags, or keep energies apart with "
        "--allow_different_observations");
  }
}

bool SameEnergy(const RunResult& a, const RunResult& b) {
  return a.scan == b.scan && a.fingerprint == b.fingerprint &&
         Close(a.trace[0].e_tex, b.trace[0].e_tex) &&
         Close(a.Get("lambda1"), b.Get("lambda1")) &&
         Close(a.Get("lambda2"), b.Get("lambda2"));
}

double BestEnergy(const RunResult& run, const std::vector<RunResult>& runs) {
  double best = run.trace[0].e_tex;
  for (const RunResult& other : runs) {
    if (!Finished(other) || !SameEnergy(run, other)) continue;
    for (const TracePoint& point : other.trace) {
      if (point.level == 0) best = std::min(best, point.e_tex);
    }
  }
  return best;
}

void CompareRuns(std::vector<RunResult>* runs) {
  for (RunResult& run : *runs) {
    if (!Finished(run)) continue;
    for (const RunResult& other : *runs) {
      if (!Finished(other) || other.scan != run.scan || other.variant != 0) {
        continue;
      }
      run.same_observations = run.fingerprint == other.fingerprint;
      run.same_energy = SameEnergy(run, other);
    }
    std::vector<double> times, energies;
    for (const TracePoint& point : run.trace) {
      if (point.level > 0) continue;
      times.push_back(point.cpu_s);
      energies.push_back(point.e_tex);
    }
    run.figures[FigureIndex("cpu_s_to_99")] =
        TimeToReach(0.99, energies[0], BestEnergy(run, *runs), times, energies);
  }
}

}  // namespace facet
