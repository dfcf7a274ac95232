// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Texels: sample points on the planes of the mesh (paper, Sec. 3.3; method
// ch. 4). A texel is a point p on a face of the simplified mesh; its plane
// point q = p - (n.p + w) n is recomputed whenever the plane changes.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "mesh/planar_partition.h"
#include "mesh/tri_mesh.h"

namespace facet {

struct Atlas;  // texture/atlas.h

// Structure of arrays, sorted by plane, then chart, row and column.
struct TexelSet {
  double spacing_m = 0;  // of the full grid [m]
  int stride = 1;        // every stride-th column and row of it is here
  std::vector<Eigen::Vector3f> position;  // p on the mesh, world [m]
  std::vector<int> plane;                 // cluster id
  std::vector<int> face;
  std::vector<std::array<float, 2>> bary;  // b1, b2; b0 = 1 - b1 - b2
  // Texels left out because of the edge margin: points of E_p only.
  std::vector<Eigen::Vector3f> margin_position;
  std::vector<int> margin_plane;

  size_t size() const { return position.size(); }
};

// With a margin, texels near edges of the shape are left out: a fused mesh is
// rounded there by about a voxel, so a texel would look at what lies behind the
// edge. Cameras come out truer, but texture that lies near edges less sharp.
// E_p keeps these texels: else planes narrower than the margin were free.
struct TexelOptions {
  int stride = 1;  // every stride-th column and row; at least 1
  // Distance kept from sharp edges [m], 0 = off. Sharp are open edges, and
  // edges between clusters whose planes differ by sharp_angle_deg or whose
  // distances to the middle of the edge sum to sharp_step_m.
  double edge_margin_m = 0;
  double sharp_angle_deg = 20;
  double sharp_step_m = 0.006;
};

// The texels of all front-facing charts (steep and back ones take no part in
// E_c and E_p) on every stride-th column and row of each chart's grid, centred
// in the chart, so that charts narrower than the stride still get some. Throws
// OptionsError when the stride is below 1 or the margin negative.
TexelSet SampleTexels(const TriMesh& mesh,
                      const PlanarPartition& partition,
                      const Atlas& atlas,
                      const TexelOptions& options);

}  // namespace facet
