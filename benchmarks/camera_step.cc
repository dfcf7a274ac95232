// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The camera step with E_c in four forms: CPU time and memory of building and
// solving, four iterations, and the cost they end at.
#include <malloc.h>

#include <cmath>

#include "benchmarks/bench_args.h"
#include "benchmarks/camera_problem.h"

namespace facet {
namespace {

struct Measured {
  double build_s = 0, solve_s = 0;
  double cost_before = 0, cost_after = 0;
  double bytes_per_residual = 0;  // of Ceres, at the worst keyframe
  int iterations = 0;
};

double MegaBytesNow() {
  malloc_trim(0);
  ResetPeakRss();
  return PeakRssMb();
}

Measured SolveAllCameras(const BenchScene& bench, CostForm form) {
  const TextureProblem& problem = bench.scene.problem;
  ReconState state = bench.start;
  const std::vector<PhotoChannel> channels =
      MakePhotoChannels(problem, state, PointsAt::kPlane);
  Measured sum;
  for (int k = 0; k < problem.NumKeyframes(); ++k) {
    const double before_mb = MegaBytesNow();
    const Stopwatch build;
    CameraProblem camera(bench, channels, form, k, &state);
    sum.build_s += build.CpuSecondsSince();
    const Stopwatch solve;
    ceres::Solver::Summary summary;
    ceres::Solve(CameraSolverOptions(4), camera.ceres_problem(), &summary);
    sum.solve_s += solve.CpuSecondsSince();
    const double bytes = (PeakRssMb() - before_mb) * (1 << 20);
    const size_t residuals =
        (problem.observations.begin[k + 1] - problem.observations.begin[k]) *
        problem.NumChannels();
    sum.bytes_per_residual = std::max(sum.bytes_per_residual,
                                      bytes / static_cast<double>(residuals));
    sum.iterations += static_cast<int>(summary.iterations.size()) - 1;
    sum.cost_before += summary.initial_cost;
    sum.cost_after += summary.final_cost;
  }
  return sum;
}

// Returns whether all forms end at the same cost.
bool MeasureForms(size_t observations,
                  int keyframes,
                  int repetitions,
                  const std::vector<CostForm>& forms) {
  const BenchScene bench = MakeBenchScene({observations, keyframes});
  double first_s = 0, first_cost = 0;
  bool same = true;
  for (const CostForm form : forms) {
    Measured best = SolveAllCameras(bench, form);
    // The slow forms take so long that noise does not matter to them.
    const int more = form == CostForm::kCompressed ? 2 * repetitions
                     : form == CostForm::kBatched  ? repetitions - 1
                                                   : 0;
    for (int i = 0; i < more; ++i) {
      const Measured again = SolveAllCameras(bench, form);
      if (again.build_s + again.solve_s < best.build_s + best.solve_s) {
        best.build_s = again.build_s;
        best.solve_s = again.solve_s;
      }
    }
    const double total_s = best.build_s + best.solve_s;
    if (first_s == 0) {
      first_s = total_s;
      first_cost = best.cost_after;
    }
    same = same && std::abs(best.cost_after - first_cost) < 1e-4 * first_cost;
    char ratio[16] = "";  // to the first form, if it is not alone
    if (forms.size() > 1) {
      std::snprintf(ratio, sizeof(ratio), "%.3g", total_s / first_s);
    }
    std::printf("%s,%zu,%.4g,%.4g,%.4g,%s,%.0f,%d,%.7g,%.7g\n",
                kCostFormNames[static_cast<int>(form)],
                bench.scene.problem.observations.size(),
                best.build_s,
                best.solve_s,
                total_s,
                ratio,
                best.bytes_per_residual,
                best.iterations,
                best.cost_before,
                best.cost_after);
    std::fflush(stdout);
  }
  return same;
}

}  // namespace
}  // namespace facet

int main(int argc, char** argv) {
  using namespace facet;
  const BenchArgs args = StartBenchmark(argc, argv);
  std::printf(
      "form,observations,build_s,solve_s,cpu_s,ratio,ceres_bytes,iterations,"
      "cost_before,cost_after\n");
  const std::vector<CostForm> all = {CostForm::kCompressed,
                                     CostForm::kBatched,
                                     CostForm::kAnalytic,
                                     CostForm::kAutodiff};
  bool same = MeasureForms(
      args.small ? 20000 : 1200000, args.small ? 4 : 12, args.repetitions, all);
  if (!args.small) {
    MeasureForms(10000000, 12, args.repetitions, {CostForm::kCompressed});
  }
  if (!same) std::fprintf(stderr, "the forms end at different costs\n");
  return same ? 0 : 1;
}
