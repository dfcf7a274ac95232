// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Which faces use an edge, for any triangle soup (non-manifold edges too): one
// sorted array, and from it the faces that share edges. Method, Sec. 2.4.
#pragma once

#include <utility>
#include <vector>

#include "mesh/tri_mesh.h"

namespace facet {

// Face corner / 3 has the edge low-high, from its vertex corner % 3 to the next
// one. `Forward` tells whether the face runs from low to high.
struct EdgeUse {
  int low = 0, high = 0;  // vertices, low < high
  int corner = 0;

  int Face() const { return corner / 3; }
  bool SameEdge(const EdgeUse& other) const {
    return low == other.low && high == other.high;
  }
  bool Forward(const TriMesh& mesh) const {
    return mesh.faces[corner / 3][corner % 3] == low;
  }
};

// All 3F uses sorted by (low, high, corner). Linear time.
std::vector<EdgeUse> SortedEdgeUses(const TriMesh& mesh);

// Calls visit(begin, end) with the range of uses of every edge, in order.
template <typename Visit>
void ForEachEdge(const std::vector<EdgeUse>& uses, const Visit& visit) {
  for (size_t begin = 0, end = 0; begin < uses.size(); begin = end) {
    while (end < uses.size() && uses[end].SameEdge(uses[begin])) ++end;
    visit(begin, end);
  }
}

// Pairs of faces that share an edge, in the order of the edges; all pairs of an
// edge with more than two faces. Two faces may share two edges.
std::vector<std::pair<int, int>> FacePairs(const TriMesh& mesh);

// The same as lists: neighbours of face f are neighbors[begin[f]] up to, but
// not including, neighbors[begin[f + 1]].
struct FaceNeighbors {
  std::vector<int> begin;
  std::vector<int> neighbors;
};
FaceNeighbors BuildFaceNeighbors(const TriMesh& mesh);

}  // namespace facet
