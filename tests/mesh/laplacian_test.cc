// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "mesh/laplacian.h"

#include <gtest/gtest.h>

#include "tests/mesh/plane_scenes.h"

namespace facet {
namespace {

Eigen::MatrixX3d Positions(const TriMesh& mesh) {
  Eigen::MatrixX3d x(mesh.NumVertices(), 3);
  for (size_t v = 0; v < mesh.NumVertices(); ++v) {
    x.row(v) = mesh.vertices[v].transpose();
  }
  return x;
}

// Breaks if weights of a row do not sum to zero: constants are its null space.
TEST(Laplacian, ConstantsVanish) {
  const LabelledMesh sheet =
      MakeSheet(4, [](double x, double y) { return x * y; });
  for (const auto kind : {LaplacianKind::kGlobal, LaplacianKind::kFeature}) {
    for (const auto boundary : {LaplacianBoundary::kPaper,
                                LaplacianBoundary::kChain,
                                LaplacianBoundary::kFixed}) {
      const auto matrix = LaplacianMatrix(
          MakeLaplacianStencils(
              sheet.mesh, sheet.partition.face_cluster, boundary, kind)
              .rings);
      const Eigen::VectorXd ones = Eigen::VectorXd::Ones(matrix.cols());
      EXPECT_LT((matrix * ones).norm(), 1e-12);
    }
  }
}

// Breaks if boundary vertices see the inside: along a straight, even boundary
// the chain Laplacian is zero, the paper's pulls inwards.
TEST(Laplacian, ChainKeepsStraightBoundaries) {
  const LabelledMesh sheet = MakeSheet(4, [](double, double) { return 0.0; });
  const auto row_norm = [&](LaplacianBoundary boundary) {
    const auto matrix = LaplacianMatrix(
        MakeLaplacianStencils(sheet.mesh, {}, boundary, LaplacianKind::kGlobal)
            .rings);
    const Eigen::MatrixX3d lx = matrix * Positions(sheet.mesh);
    for (size_t v = 0; v < sheet.mesh.NumVertices(); ++v) {
      const Eigen::Vector3d& p = sheet.mesh.vertices[v];
      if (p.x() == 0 && std::abs(p.y() - 0.5) < 1e-9) return lx.row(v).norm();
    }
    return -1.0;
  };
  EXPECT_NEAR(row_norm(LaplacianBoundary::kChain), 0, 1e-12);
  EXPECT_GT(row_norm(LaplacianBoundary::kPaper), 0.01);
  EXPECT_EQ(row_norm(LaplacianBoundary::kFixed), 0);
}

// Breaks if the feature Laplacian reaches across an edge between planes or
// gives corners a row: on a cube of even grids nothing is pulled off its edges.
TEST(Laplacian, FeatureKeepsTheEdgesOfACube) {
  const LabelledMesh cube = MakeCube(4);
  const auto norm = [&](LaplacianKind kind) {
    return (LaplacianMatrix(MakeLaplacianStencils(cube.mesh,
                                                  cube.partition.face_cluster,
                                                  LaplacianBoundary::kChain,
                                                  kind)
                                .rings) *
            Positions(cube.mesh))
        .norm();
  };
  EXPECT_LT(norm(LaplacianKind::kFeature), 1e-12);
  EXPECT_GT(norm(LaplacianKind::kGlobal), 0.1);
}

}  // namespace
}  // namespace facet
