// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Distances between two surfaces, both ways (method, Sec. 11.4): points spread
// over one by area, each with the exact distance to the other's triangles.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "mesh/tri_mesh.h"
#include "render/ray_scene.h"

namespace facet {

struct SurfaceSample {
  Eigen::Vector3d point;  // [m]
  int face;
};

// `count` points, independent and uniform over the area, a function of mesh and
// seed alone. Throws UnsolvableError for a mesh without area.
std::vector<SurfaceSample> SampleSurface(const TriMesh& mesh,
                                         size_t count,
                                         uint64_t seed);

// Of distances in metres.
struct DistanceStats {
  double mean = 0, median = 0, rms = 0, p90 = 0, max = 0;
};

inline constexpr std::array<double, 3> kFScoreThresholds = {0.01, 0.02, 0.05};

struct MeshDistance {
  DistanceStats accuracy;      // model to reference
  DistanceStats completeness;  // reference to model
  // Shares of points nearer than kFScoreThresholds [m], and 2 P R / (P + R).
  std::array<double, 3> precision{}, recall{}, f_score{};
};

struct MeshDistanceOptions {
  size_t num_points = 1000000;  // on each mesh
  uint64_t seed = 0;
};

MeshDistance CompareMeshes(const TriMesh& model,
                           const TriMesh& reference,
                           const MeshDistanceOptions& options);

}  // namespace facet
