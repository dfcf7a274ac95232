// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "mesh/adjacency.h"

#include <algorithm>

#include "mesh/edge_uses.h"

namespace facet {

std::vector<MeshEdge> CollectEdges(const TriMesh& mesh) {
  const std::vector<EdgeUse> uses = SortedEdgeUses(mesh);
  std::vector<MeshEdge> edges;
  edges.reserve(uses.size() / 2 + 16);
  ForEachEdge(uses, [&](size_t begin, size_t end) {
    if (uses[begin].low == uses[begin].high) return;
    MeshEdge edge;
    edge.v0 = uses[begin].low;
    edge.v1 = uses[begin].high;
    edge.num_faces = static_cast<int>(end - begin);
    for (size_t i = begin; i < std::min(end, begin + 2); ++i) {
      edge.face[i - begin] = uses[i].Face();
    }
    edges.push_back(edge);
  });
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
