// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "mesh/laplacian.h"

namespace facet {

LaplacianStencils MakeLaplacianStencils(const TriMesh& mesh,
                                        const std::vector<int>& face_cluster,
                                        LaplacianBoundary boundary,
                                        LaplacianKind kind) {
  const size_t n = mesh.NumVertices();
  const std::vector<MeshEdge> edges = CollectEdges(mesh);
  LaplacianStencils stencils;
  stencils.boundary.assign(n, 0);
  std::vector<int> border_degree(n, 0);
  for (const MeshEdge& edge : edges) {
    if (edge.num_faces != 2) {
      stencils.boundary[edge.v0] = stencils.boundary[edge.v1] = 1;
    }
    if (kind == LaplacianKind::kFeature && IsBorder(edge, face_cluster)) {
      ++border_degree[edge.v0];
      ++border_degree[edge.v1];
    }
  }

  const auto counts = [&](int v, const MeshEdge& edge) {
    if (stencils.boundary[v]) {
      if (boundary == LaplacianBoundary::kFixed) return false;
      if (boundary == LaplacianBoundary::kChain && edge.num_faces == 2) {
        return false;
      }
    }
    if (border_degree[v] == 0) return true;
    return border_degree[v] == 2 && IsBorder(edge, face_cluster);
  };
  // Rings are directed here: i may count j without j counting i.
  VertexRings& rings = stencils.rings;
  rings.begin.assign(n + 1, 0);
  for (const MeshEdge& edge : edges) {
    rings.begin[edge.v0 + 1] += counts(edge.v0, edge);
    rings.begin[edge.v1 + 1] += counts(edge.v1, edge);
  }
  for (size_t v = 0; v < n; ++v) rings.begin[v + 1] += rings.begin[v];
  rings.neighbor.resize(rings.begin[n]);
  std::vector<int> next(rings.begin.begin(), rings.begin.end() - 1);
  for (const MeshEdge& edge : edges) {
    if (counts(edge.v1, edge)) rings.neighbor[next[edge.v1]++] = edge.v0;
  }
  for (const MeshEdge& edge : edges) {
    if (counts(edge.v0, edge)) rings.neighbor[next[edge.v0]++] = edge.v1;
  }
  return stencils;
}

Eigen::SparseMatrix<double> LaplacianMatrix(const VertexRings& rings) {
  const int n = static_cast<int>(rings.begin.size()) - 1;
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(rings.neighbor.size() + n);
  for (int i = 0; i < n; ++i) {
    const int degree = rings.begin[i + 1] - rings.begin[i];
    if (degree == 0) continue;
    entries.emplace_back(i, i, 1.0);
    for (int k = rings.begin[i]; k < rings.begin[i + 1]; ++k) {
      entries.emplace_back(i, rings.neighbor[k], -1.0 / degree);
    }
  }
  Eigen::SparseMatrix<double> matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

}  // namespace facet
