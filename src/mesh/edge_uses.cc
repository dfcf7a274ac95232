// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "mesh/edge_uses.h"

#include <algorithm>

namespace facet {

std::vector<EdgeUse> SortedEdgeUses(const TriMesh& mesh) {
  // Counting sort by the lower vertex; a vertex has few edges, so the rest is
  // cheap.
  std::vector<int> begin(mesh.NumVertices() + 1, 0);
  for (const auto& f : mesh.faces) {
    for (int k = 0; k < 3; ++k) ++begin[std::min(f[k], f[(k + 1) % 3]) + 1];
  }
  for (size_t v = 1; v < begin.size(); ++v) begin[v] += begin[v - 1];
  std::vector<EdgeUse> uses(3 * mesh.NumFaces());
  std::vector<int> next(begin.begin(), begin.end() - 1);
  for (size_t i = 0; i < mesh.NumFaces(); ++i) {
    const auto& f = mesh.faces[i];
    for (int k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(f[k], f[(k + 1) % 3]);
      uses[next[low]++] = {low, high, static_cast<int>(3 * i + k)};
    }
  }
  for (size_t v = 0; v + 1 < begin.size(); ++v) {
    std::sort(uses.begin() + begin[v],
              uses.begin() + begin[v + 1],
              [](const EdgeUse& a, const EdgeUse& b) {
                return a.high != b.high ? a.high < b.high : a.corner < b.corner;
              });
  }
  return uses;
}

std::vector<std::pair<int, int>> FacePairs(const TriMesh& mesh) {
  const std::vector<EdgeUse> uses = SortedEdgeUses(mesh);
  std::vector<std::pair<int, int>> pairs;
  pairs.reserve(uses.size() / 2);
  ForEachEdge(uses, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      for (size_t j = i + 1; j < end; ++j) {
        pairs.emplace_back(uses[i].Face(), uses[j].Face());
      }
    }
  });
  return pairs;
}

FaceNeighbors BuildFaceNeighbors(const TriMesh& mesh) {
  const std::vector<std::pair<int, int>> pairs = FacePairs(mesh);
  FaceNeighbors result;
  result.begin.assign(mesh.NumFaces() + 1, 0);
  for (const auto& [a, b] : pairs) {
    ++result.begin[a + 1];
    ++result.begin[b + 1];
  }
  for (size_t f = 0; f < mesh.NumFaces(); ++f) {
    result.begin[f + 1] += result.begin[f];
  }
  result.neighbors.resize(2 * pairs.size());
  std::vector<int> next(result.begin.begin(), result.begin.end() - 1);
  for (const auto& [a, b] : pairs) {
    result.neighbors[next[a]++] = b;
    result.neighbors[next[b]++] = a;
  }
  return result;
}

}  // namespace facet
