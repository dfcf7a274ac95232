// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Neighbourhoods of a triangle mesh as flat, sorted arrays.
#pragma once

#include <array>
#include <vector>

#include "mesh/tri_mesh.h"

namespace facet {

// An undirected edge, v0 < v1.
struct MeshEdge {
  int v0 = 0, v1 = 0;
  int num_faces = 0;                   // 1 = mesh boundary, > 2 = non-manifold
  std::array<int, 2> face = {-1, -1};  // the first two faces, ascending
};

// All edges, sorted by (v0, v1). Works on any polygon soup; a side that joins a
// vertex to itself is no edge.
std::vector<MeshEdge> CollectEdges(const TriMesh& mesh);

// Is `edge` part of a cluster border: mesh boundary, non-manifold, or between
// two clusters (method, Sec. 3.1)?
inline bool IsBorder(const MeshEdge& edge,
                     const std::vector<int>& face_cluster) {
  return edge.num_faces != 2 ||
         face_cluster[edge.face[0]] != face_cluster[edge.face[1]];
}

// Neighbours of vertex v: neighbor[begin[v]] .. neighbor[begin[v + 1] - 1],
// ascending.
struct VertexRings {
  std::vector<int> begin;  // num_vertices + 1
  std::vector<int> neighbor;
};

// The rings that `edges` span.
VertexRings MakeVertexRings(const std::vector<MeshEdge>& edges,
                            size_t num_vertices);

}  // namespace facet
