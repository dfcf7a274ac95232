// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// One joint phase C+Phi+T by every method (problems/joint_method.h) from the
// same state: CPU time, memory besides the problem's, and the objective it ends
// at, by the number of views a texel.
#include <malloc.h>

#include "benchmarks/bench_args.h"
#include "benchmarks/bench_scene.h"
#include "problems/solve_blocks.h"

namespace facet {
namespace {

void MeasureMethod(const BenchScene& bench,
                   const std::string& name,
                   const SolverConfig& config,
                   int repetitions) {
  const TextureProblem& problem = bench.scene.problem;
  const EnergyTerms before =
      EvaluateEnergy(problem, bench.weights, bench.start);
  malloc_trim(0);
  ResetPeakRss();
  const double mb_before = PeakRssMb();
  PhaseSummary summary;
  const double seconds = BestCpuSeconds(repetitions, [&] {
    ReconState state = bench.start;
    SolverMemory memory;
    summary = SolveBlocks(problem,
                          bench.weights,
                          kColors | kPlanes | kPoses,
                          config,
                          before,
                          &memory,
                          &state);
  });
  const double n = static_cast<double>(problem.observations.size());
  std::printf("%s,%d,%.1f,%zu,%.4g,%.4g,%d,%.5g,%.5g,%.0f\n",
              name.c_str(),
              problem.NumKeyframes(),
              n / static_cast<double>(problem.texels.size()),
              problem.observations.size(),
              seconds,
              1e9 * seconds / n,
              summary.iterations,
              before.Objective(),
              summary.after.Objective(),
              PeakRssMb() - mb_before);
  std::fflush(stdout);
}

void MeasureMethods(const BenchSize& size, int repetitions) {
  const BenchScene bench = MakeBenchScene(size);
  SolverConfig config;
  config.trace_rms_grey = false;
  for (const JointMethod method : AllJointMethods()) {
    config.joint_method = method;
    MeasureMethod(bench, JointMethodName(method), config, repetitions);
  }
  config.joint_method = JointMethod::kConsensus;
  config.joint_linear_solver = JointLinearSolver::kCholesky;
  MeasureMethod(bench, "consensus (Cholesky)", config, repetitions);
}

}  // namespace
}  // namespace facet

int main(int argc, char** argv) {
  using namespace facet;
  const BenchArgs args = StartBenchmark(argc, argv);
  std::printf(
      "method,keyframes,views,observations,cpu_s,ns,iterations,"
      "objective_before,objective_after,work_mb\n");
  if (args.small) {
    MeasureMethods({3000, 4, 160, 120}, 1);
    return 0;
  }
  for (const int keyframes : {20, 60}) {
    MeasureMethods({200000, keyframes, 320, 240}, 2);
  }
}
