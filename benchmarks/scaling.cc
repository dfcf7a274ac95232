// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Phases of a schedule over texels x keyframes x views a texel: CPU time an
// observation, and memory.
//
//   C_ns ...       CPU time of one phase, an observation [ns]
//   store_bytes    what stays in memory an observation, without images
//   texel_bytes    the same, a texel
//   work_mb        what all phases take besides, at most
#include <malloc.h>

#include "benchmarks/bench_args.h"
#include "benchmarks/bench_scene.h"
#include "problems/solve_blocks.h"

namespace facet {
namespace {

template <typename T>
double Bytes(const std::vector<T>& v) {
  return static_cast<double>(v.size() * sizeof(T));
}

double ObservationBytes(const TextureProblem& problem) {
  return Bytes(problem.observations.texel) + Bytes(problem.segments);
}

double TexelBytes(const TextureProblem& problem, const ReconState& state) {
  const TexelSet& texels = problem.texels;
  return Bytes(texels.position) + Bytes(texels.plane) + Bytes(texels.face) +
         Bytes(texels.bary) + Bytes(problem.views) + Bytes(problem.tiles) +
         Bytes(state.colors);
}

void Measure(size_t observations, int keyframes, int repetitions) {
  const BenchScene bench = MakeBenchScene({observations, keyframes, 320, 240});
  const TextureProblem& problem = bench.scene.problem;
  SolverConfig config;
  config.trace_rms_grey = false;
  const EnergyTerms before =
      EvaluateEnergy(problem, bench.weights, bench.start);
  const double n = static_cast<double>(problem.observations.size());
  const double texels = static_cast<double>(problem.texels.size());
  std::printf("%zu,%d,%.1f,%zu",
              problem.texels.size(),
              keyframes,
              n / texels,
              problem.observations.size());
  malloc_trim(0);
  ResetPeakRss();
  const double rss_before = PeakRssMb();
  for (const unsigned blocks : {unsigned{kColors},
                                unsigned{kPlanes},
                                unsigned{kPoses},
                                unsigned{kPoses} | kWarps,
                                unsigned{kColors} | kPoses,
                                unsigned{kColors} | kPoses | kPlanes}) {
    const double seconds = BestCpuSeconds(repetitions, [&] {
      ReconState state = bench.start;
      SolverMemory memory;
      SolveBlocks(
          problem, bench.weights, blocks, config, before, &memory, &state);
    });
    std::printf(",%.1f", 1e9 * seconds / n);
    std::fflush(stdout);
  }
  std::printf(",%.2f,%.1f,%.0f\n",
              ObservationBytes(problem) / n,
              TexelBytes(problem, bench.start) / texels,
              PeakRssMb() - rss_before);
  std::fflush(stdout);
}

}  // namespace
}  // namespace facet

int main(int argc, char** argv) {
  using namespace facet;
  const BenchArgs args = StartBenchmark(argc, argv);
  std::printf(
      "texels,keyframes,views,observations,C_ns,Phi_ns,T_ns,TF_ns,CT_ns,"
      "CPhiT_ns,store_bytes,texel_bytes,work_mb\n");
  if (args.small) {
    Measure(20000, 4, 1);
    return 0;
  }
  for (const int keyframes : {5, 20, 60}) {
    for (const size_t observations : {300000, 3000000}) {
      Measure(observations, keyframes, (args.repetitions + 1) / 2);
    }
  }
}
