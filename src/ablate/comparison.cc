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

// CPU time after which the finest level's E_tex came down to `share` of the way
// to `goal`; NaN if it never did.
double CpuToReach(const RunResult& run, double share, double goal) {
  std::vector<double> times, energies;
  for (const TracePoint& point : run.trace) {
    if (point.level > 0) continue;
    times.push_back(point.cpu_s);
    energies.push_back(point.e_tex);
  }
  return TimeToReach(share, energies[0], goal, times, energies);
}

void CompareWithReference(const RunResult& reference, RunResult* run) {
  run->same_observations = run->fingerprint == reference.fingerprint;
  run->same_energy = SameEnergy(*run, reference);
  if (!run->same_energy) return;
  const double goal = reference.trace.back().e_tex;
  const double cpu_s = CpuToReach(*run, 1, goal);
  run->figures[FigureIndex("cpu_s_to_reference")] = cpu_s;
  run->figures[FigureIndex("speedup_to_reference")] =
      CpuToReach(reference, 1, goal) / cpu_s;
}

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
      if (Finished(other) && other.scan == run.scan && other.variant == 0) {
        CompareWithReference(other, &run);
      }
    }
    run.figures[FigureIndex("cpu_s_to_99")] =
        CpuToReach(run, 0.99, BestEnergy(run, *runs));
  }
}

}  // namespace facet
