// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The geometry step (problems/geometry_problem.h): the direct solve against the
// same normal equations built and solved by Ceres. A cube with noise on its
// vertices; gap_m is the largest distance between the two results.
#include "benchmarks/bench_args.h"
#include "problems/geometry_problem.h"
#include "tests/mesh/plane_scenes.h"
#include "util/random.h"

namespace facet {
namespace {

// Returns whether both agree.
bool Measure(int n, int repetitions) {
  LabelledMesh scene = MakeCube(n);
  Random random(3);
  const double edge = 1.0 / n;
  for (Eigen::Vector3d& v : scene.mesh.vertices) {
    const double x = random.Uniform(-1, 1), y = random.Uniform(-1, 1);
    v += 0.05 * edge * Eigen::Vector3d(x, y, random.Uniform(-1, 1));
  }
  std::vector<Plane> planes;
  for (const PlaneCluster& c : scene.partition.clusters) {
    planes.push_back(c.plane);
  }
  TriMesh results[2];
  double seconds[2];
  for (const bool use_ceres : {false, true}) {
    GeometryOptions options;
    options.use_ceres = use_ceres;
    seconds[use_ceres] = BestCpuSeconds(use_ceres ? 1 : repetitions, [&] {
      results[use_ceres] = scene.mesh;
      FitGeometry(
          scene.partition, planes, 0.0025, options, &results[use_ceres]);
    });
  }
  double gap = 0;
  for (size_t v = 0; v < scene.mesh.NumVertices(); ++v) {
    gap =
        std::max(gap, (results[0].vertices[v] - results[1].vertices[v]).norm());
  }
  std::printf("%zu,%.4g,%.4g,%.3g\n",
              scene.mesh.NumFaces(),
              seconds[0],
              seconds[1],
              gap);
  std::fflush(stdout);
  return gap < 1e-6;
}

}  // namespace
}  // namespace facet

int main(int argc, char** argv) {
  using namespace facet;
  const BenchArgs args = StartBenchmark(argc, argv);
  std::printf("faces,direct_s,ceres_s,gap_m\n");
  bool agree = true;
  for (const int n : {4, 16, 32, 48}) {
    if (args.small && n > 4) break;
    agree = Measure(n, args.repetitions) && agree;
  }
  if (!agree) std::fprintf(stderr, "direct solve and Ceres differ\n");
  return agree ? 0 : 1;
}
