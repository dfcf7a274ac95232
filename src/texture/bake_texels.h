// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The texels of the final texture at full density, gutter included, in tiles
// (method, Sec. 4.3 and 4.6).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "geometry/plane.h"
#include "mesh/tri_mesh.h"
#include "texture/atlas.h"

namespace facet {

inline constexpr int kBakeTilePx = 32;

// Texels of up to kBakeTilePx x kBakeTilePx px of one chart: [begin, owned_end)
// lie in a face; [owned_end, end) are gutter texels that follow one of them.
struct BakeTile {
  int chart = 0;
  uint32_t begin = 0, owned_end = 0, end = 0;
};

// Structure of arrays over all texels, tile by tile.
struct BakeTexels {
  std::vector<BakeTile> tiles;        // by chart
  std::vector<uint32_t> chart_tiles;  // charts + 1: first tile of each
  // On the mesh, world [m]. Of use for visibility only, and then released.
  std::vector<Eigen::Vector3f> p;
  std::vector<Eigen::Vector3f> q;  // to be coloured, world [m]
  std::vector<uint32_t> pixel;     // row * chart.width + column
  // Index of the owned texel whose visibility this one shares: the first of its
  // tile in the same square of `share_px` texels. Gutter texels share that of
  // the texel they follow.
  std::vector<uint32_t> source;
  std::vector<int> face;  // gutter: of the texel they follow

  size_t size() const { return pixel.size(); }
};

// p from the vertices of `mesh` (which may have moved since the atlas was
// built); q = p projected onto its plane, for steep charts q = p. A gutter
// texel up to `ring_px` (8-neighbour steps) away from an owned one continues
// the chart in its plane: q = q_source + h (dx e1 + dy e2). A chart without any
// owned texel gets one, at the centroid of its largest face. On steep charts
// only texels of one face share a source. All but p and q depends on the atlas
// only.
BakeTexels MakeBakeTexels(const TriMesh& mesh,
                          const std::vector<Plane>& planes,
                          const Atlas& atlas,
                          int ring_px,
                          int share_px);

// The q of `texels`, which are of the same atlas, ring_px and share_px, in
// another state of the model: it needs a third of the memory of all of them.
std::vector<Eigen::Vector3f> MakeBakePoints(const TriMesh& mesh,
                                            const std::vector<Plane>& planes,
                                            const Atlas& atlas,
                                            int ring_px,
                                            int share_px,
                                            const BakeTexels& texels);

}  // namespace facet
