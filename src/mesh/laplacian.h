// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The uniform Laplacian L of a mesh (paper, Sec. 3.4; method, Sec. 8.1, 8.5):
//
//   (L X)_i = x_i - 1/|N(i)| sum_{j in N(i)} x_j          E_t = |L X|_F^2
//
// Which neighbours count is a choice: the plain Laplacian pulls the rim of a
// hole inwards and rounds edges between planes.
#pragma once

#include <Eigen/SparseCore>
#include <cstdint>
#include <vector>

#include "mesh/adjacency.h"
#include "mesh/tri_mesh.h"

namespace facet {

enum class LaplacianBoundary {
  kPaper,  // boundary vertices like all others
  kChain,  // N(i) = the neighbours along the boundary
  kFixed,  // no row, and the vertex does not move
};

enum class LaplacianKind {
  kGlobal,   // all neighbours, across planes
  kFeature,  // border vertices of clusters: the neighbours along the border;
             // corners (other than two border edges) have no row
};

struct LaplacianStencils {
  VertexRings rings;              // empty ring = no row
  std::vector<uint8_t> boundary;  // a vertex: lies on the mesh boundary
};

// `face_cluster` is read for kFeature only.
LaplacianStencils MakeLaplacianStencils(const TriMesh& mesh,
                                        const std::vector<int>& face_cluster,
                                        LaplacianBoundary boundary,
                                        LaplacianKind kind);

// L as a square matrix; vertices without a stencil have an empty row.
Eigen::SparseMatrix<double> LaplacianMatrix(const VertexRings& rings);

}  // namespace facet
