// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "eval/mesh_distance.h"

#include <algorithm>
#include <cmath>

#include "util/errors.h"
#include "util/parallel_for.h"
#include "util/random.h"

namespace facet {
namespace {

constexpr size_t kChunk = 1024;

std::vector<double> DistancesTo(const RayScene& scene,
                                const std::vector<SurfaceSample>& samples) {
  std::vector<double> distances(samples.size());
  ParallelForChunks(0, samples.size(), kChunk, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      distances[i] = scene.NearestPoint(samples[i].point).distance;
    }
  });
  return distances;
}

DistanceStats Summarise(std::vector<double> distances) {
  DistanceStats stats;
  double sum = 0, squares = 0;
  for (const double d : distances) {
    sum += d;
    squares += d * d;
  }
  const double n = static_cast<double>(distances.size());
  stats.mean = sum / n;
  stats.rms = std::sqrt(squares / n);
  std::sort(distances.begin(), distances.end());
  const auto quantile = [&](double share) {
    return distances[static_cast<size_t>(share * (n - 1))];
  };
  stats.median = quantile(0.5);
  stats.p90 = quantile(0.9);
  stats.max = distances.back();
  return stats;
}

double ShareBelow(const std::vector<double>& distances, double threshold) {
  const auto count = std::count_if(distances.begin(),
                                   distances.end(),
                                   [&](double d) { return d < threshold; });
  return static_cast<double>(count) / static_cast<double>(distances.size());
}

}  // namespace

std::vector<SurfaceSample> SampleSurface(const TriMesh& mesh,
                                         size_t count,
                                         uint64_t seed) {
  std::vector<double> area_before(mesh.NumFaces() + 1, 0.0);
  for (size_t f = 0; f < mesh.NumFaces(); ++f) {
    area_before[f + 1] = area_before[f] + mesh.FaceArea(f);
  }
  const double total = area_before.back();
  if (!(total > 0)) {
    throw UnsolvableError(
        "a mesh without surface area cannot be compared: it has no faces, or "
        "none that is not degenerate");
  }
  Random random(seed);
  std::vector<SurfaceSample> samples(count);
  for (SurfaceSample& sample : samples) {
    const double target = random.Uniform() * total;
    // The last face that begins at or before the target: faces without area
    // are skipped.
    const auto after =
        std::upper_bound(area_before.begin(), area_before.end() - 1, target);
    sample.face = static_cast<int>(after - area_before.begin()) - 1;
    double u = random.Uniform(), v = random.Uniform();
    if (u + v > 1) {
      u = 1 - u;
      v = 1 - v;
    }
    const std::array<int, 3>& f = mesh.faces[sample.face];
    sample.point = (1 - u - v) * mesh.vertices[f[0]] + u * mesh.vertices[f[1]] +
                   v * mesh.vertices[f[2]];
  }
  return samples;
}

MeshDistance CompareMeshes(const TriMesh& model,
                           const TriMesh& reference,
                           const MeshDistanceOptions& options) {
  const auto model_points =
      SampleSurface(model, options.num_points, options.seed);
  const auto reference_points =
      SampleSurface(reference, options.num_points, options.seed);
  const std::vector<double> to_reference =
      DistancesTo(RayScene(reference), model_points);
  const std::vector<double> to_model =
      DistancesTo(RayScene(model), reference_points);
  MeshDistance result;
  result.accuracy = Summarise(to_reference);
  result.completeness = Summarise(to_model);
  for (size_t k = 0; k < kFScoreThresholds.size(); ++k) {
    const double p = ShareBelow(to_reference, kFScoreThresholds[k]);
    const double r = ShareBelow(to_model, kFScoreThresholds[k]);
    result.precision[k] = p;
    result.recall[k] = r;
    result.f_score[k] = p + r > 0 ? 2 * p * r / (p + r) : 0;
  }
  return result;
}

}  // namespace facet
