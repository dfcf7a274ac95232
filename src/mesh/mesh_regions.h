// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Division of a mesh into regions that can be worked on at the same time. It
// depends on the mesh alone, not on the number of threads.
#pragma once

#include <vector>

#include "mesh/tri_mesh.h"

namespace facet {

// Faces with whole labels that lie together.
struct MeshRegions {
  std::vector<int> faces;  // region by region, ascending within a region
  std::vector<int> begin;  // of region r: faces[begin[r]] to faces[begin[r+1]]

  int Count() const { return static_cast<int>(begin.size()) - 1; }
};

// Regions of at most `faces_per_region` faces, or of all faces of one label, by
// halving the labels along the longest side of the box of their centroids.
// `label` is 0-based, by face. A mesh without faces has one empty region.
MeshRegions DivideIntoRegions(const TriMesh& mesh,
                              const std::vector<int>& label,
                              int faces_per_region);

}  // namespace facet
