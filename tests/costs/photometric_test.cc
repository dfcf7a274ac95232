// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "costs/photometric.h"

#include <gtest/gtest.h>

#include <memory>

#include "tests/costs/photo_scene.h"
#include "tests/support/tangent_jacobian.h"

namespace facet {
namespace {

// Central differences with h = 1e-5 in double: truncation h^2 and rounding
// 1e-16 / h are both below 1e-9 of a Jacobian of size 1.
constexpr double kStep = 1e-5;
constexpr double kRelativeTolerance = 1e-6;

// Every derivative of the reference at 120 random states. Breaks if a term of
// the chain image - warp - projection - pose - plane is wrong, or if pose and
// plane manifolds do not fit to the ambient rows.
TEST(PhotometricCost, JacobianIsTheDerivativeThroughTheManifolds) {
  Random random(1);
  const LeftSe3Manifold pose_manifold;
  const AnchoredPlaneManifold plane_manifold;
  for (int trial = 0; trial < 120; ++trial) {
    const TestImage image = BilinearImage(&random);
    const PhotoScene s = MakePhotoScene(1, &random);
    const Eigen::Vector2d u = s.PixelOf(0);
    const WarpCell cell = s.lattice.Locate(u.x(), u.y());
    const std::unique_ptr<ceres::CostFunction> cost(
        PhotometricCost::Create(PhotometricCost(image.view(),
                                                s.camera,
                                                s.lattice,
                                                cell.a,
                                                cell.b,
                                                s.p[0],
                                                s.anchor)));
    TangentBlocks blocks;
    blocks.values = {s.pose,
                     s.plane,
                     {0.4},
                     s.Vertex(cell.a, cell.b),
                     s.Vertex(cell.a + 1, cell.b),
                     s.Vertex(cell.a, cell.b + 1),
                     s.Vertex(cell.a + 1, cell.b + 1)};
    blocks.manifolds = {&pose_manifold,
                        &plane_manifold,
                        nullptr,
                        nullptr,
                        nullptr,
                        nullptr,
                        nullptr};
    Eigen::VectorXd r;
    const Eigen::MatrixXd j = TangentJacobian(*cost, blocks, &r);
    const Eigen::MatrixXd d = DifferenceJacobian(*cost, blocks, kStep);
    ASSERT_GT(j.norm(), 1e-3);
    EXPECT_LT((j - d).norm(), kRelativeTolerance * j.norm()) << trial;
    // Value: the chain written down once more, without warp cell and Jets.
    const Eigen::Vector2d warped = s.lattice.Apply(s.warp.data(), u);
    EXPECT_NEAR(
        r[0],
        SampleBilinear(image.view(), warped.x(), warped.y()).value - 0.4,
        1e-12);
  }
}

}  // namespace
}  // namespace facet
