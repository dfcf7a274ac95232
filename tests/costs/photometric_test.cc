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

// One cost for all: with any pose and plane manifold, and with each sampling
// that has its own derivative, the ambient rows give the derivative along the
// manifold's own increments. Two bound twins must give the same numbers.
TEST(PhotometricCost, JacobianHoldsForEveryManifoldAndSampling) {
  Random random(2);
  for (const Sampling sampling : {Sampling::kBilinear, Sampling::kBicubic}) {
    for (const PoseKind pose_kind :
         {PoseKind::kLeft, PoseKind::kRight, PoseKind::kQuaternion}) {
      for (const PlaneKind plane_kind : {PlaneKind::kAnchored,
                                         PlaneKind::kRaw4,
                                         PlaneKind::kNormalised4,
                                         PlaneKind::kOrigin,
                                         PlaneKind::kUnit4}) {
        const TestImage image = BilinearImage(&random);
        const PhotoScene s = MakePhotoScene(1, &random);
        const Eigen::Vector2d u = s.PixelOf(0);
        const WarpCell cell = s.lattice.Locate(u.x(), u.y());
        SampledImage sampled(image.view());
        sampled.sampling = sampling;
        const PhotometricCost functor(
            sampled, s.camera, s.lattice, cell.a, cell.b, s.p[0], s.anchor);
        const std::unique_ptr<ceres::Manifold> pose_manifold(
            CreatePoseManifold(pose_kind));
        const std::unique_ptr<ceres::Manifold> plane_manifold(
            CreatePlaneManifold(plane_kind, s.anchor));
        const std::unique_ptr<ceres::CostFunction> cost(
            PhotometricCost::Create(functor));
        TangentBlocks blocks;
        blocks.values = {s.pose,
                         s.plane,
                         {0.4},
                         s.Vertex(cell.a, cell.b),
                         s.Vertex(cell.a + 1, cell.b),
                         s.Vertex(cell.a, cell.b + 1),
                         s.Vertex(cell.a + 1, cell.b + 1)};
        blocks.manifolds.assign(7, nullptr);
        blocks.manifolds[0] = pose_manifold.get();
        blocks.manifolds[1] = plane_manifold.get();
        Eigen::VectorXd r, r_frame, r_plane;
        const Eigen::MatrixXd j = TangentJacobian(*cost, blocks, &r);
        const Eigen::MatrixXd d = DifferenceJacobian(*cost, blocks, kStep);
        EXPECT_LT((j - d).norm(), kRelativeTolerance * j.norm());

        TangentBlocks frame = blocks;
        frame.values.erase(frame.values.begin() + 1, frame.values.begin() + 3);
        frame.manifolds = {
            pose_manifold.get(), nullptr, nullptr, nullptr, nullptr};
        const std::unique_ptr<ceres::CostFunction> frame_cost(
            PhotometricFrameCost::Create(
                PhotometricFrameCost(functor, s.plane.data(), 0.4), true));
        const Eigen::MatrixXd j_frame =
            TangentJacobian(*frame_cost, frame, &r_frame);
        EXPECT_DOUBLE_EQ(r_frame[0], r[0]);
        EXPECT_LT((j_frame.leftCols(6) - j.leftCols(6)).norm(), 1e-12);
        EXPECT_LT((j_frame.rightCols(8) - j.rightCols(8)).norm(), 1e-12);

        std::vector<double> vertices;
        for (int k = 3; k < 7; ++k) {
          vertices.insert(
              vertices.end(), blocks.values[k].begin(), blocks.values[k].end());
        }
        TangentBlocks plane;
        plane.values = {s.plane};
        plane.manifolds = {plane_manifold.get()};
        const std::unique_ptr<ceres::CostFunction> plane_cost(
            PhotometricPlaneCost::Create(PhotometricPlaneCost(
                functor, s.pose.data(), 0.4, vertices.data())));
        const Eigen::MatrixXd j_plane =
            TangentJacobian(*plane_cost, plane, &r_plane);
        EXPECT_DOUBLE_EQ(r_plane[0], r[0]);
        EXPECT_LT((j_plane - j.middleCols(6, j_plane.cols())).norm(), 1e-12);
      }
    }
  }
}

}  // namespace
}  // namespace facet
