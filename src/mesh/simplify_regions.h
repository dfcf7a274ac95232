// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Division of a mesh into regions whose interiors can be simplified at the same
// time. It depends on the mesh alone, not on the number of threads. Internal to
// the simplification.
#pragma once

#include <vector>

#include "mesh/planar_partition.h"
#include "mesh/tri_mesh.h"

namespace facet {

// Whole clusters that lie together.
struct MeshRegions {
  std::vector<int> faces;  // region by region, ascending within a region
  std::vector<int> begin;  // of region r: faces[begin[r]] to faces[begin[r+1]]

  int Count() const { return static_cast<int>(begin.size()) - 1; }
};

// Regions of at most `faces_per_region` faces, or of a single larger cluster,
// by halving the clusters along the longest side of the box of their centroids.
// A mesh without faces has one empty region.
MeshRegions DivideIntoRegions(const TriMesh& mesh,
                              const PlanarPartition& partition,
                              int faces_per_region);

}  // namespace facet
