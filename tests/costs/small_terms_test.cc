// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The terms without images: E_p, E_s and the pose prior.
#include <gtest/gtest.h>

#include <memory>

#include "costs/depth_moment.h"
#include "costs/plane_manifold.h"
#include "costs/plane_moment.h"
#include "costs/pose_prior.h"
#include "costs/se3_manifold.h"
#include "costs/warp_offset.h"
#include "tests/costs/photo_scene.h"
#include "tests/support/tangent_jacobian.h"

namespace facet {
namespace {

// E_p from the 4x4 moments equals the sum over the points, which are never
// visited again. Breaks if the anchor is forgotten or the factor transposed.
TEST(PlaneMomentCost, EqualsTheSumOfSquaredDistances) {
  Random random(1);
  for (int trial = 0; trial < 20; ++trial) {
    const Eigen::Vector3d anchor = 3 * RandomVector(&random);
    Eigen::Matrix4d moment = Eigen::Matrix4d::Zero();
    std::vector<Eigen::Vector3d> points;
    // A flat cluster: the smallest eigenvalue is far below the others.
    for (int i = 0; i < 200; ++i) {
      Eigen::Vector3d p = RandomVector(&random);
      p.z() = 0.002 * random.Normal();
      points.push_back(anchor + p);
      const Eigen::Vector4d m(p.x(), p.y(), p.z(), 1);
      moment += m * m.transpose();
    }
    Plane plane;
    plane.normal =
        (Eigen::Vector3d::UnitZ() + 0.01 * RandomVector(&random)).normalized();
    plane.offset = -plane.normal.dot(anchor) + 0.004 * random.Normal();
    double expected = 0;
    for (const auto& p : points) {
      expected += plane.SignedDistance(p) * plane.SignedDistance(p);
    }
    const double weight = 150;
    const PlaneMomentCost cost(moment, weight);
    const std::vector<double> block = {plane.normal.x(),
                                       plane.normal.y(),
                                       plane.normal.z(),
                                       plane.SignedDistance(anchor)};
    EXPECT_NEAR(Residuals(cost, {block}).squaredNorm(),
                weight * expected,
                1e-9 * weight * expected);
    const AnchoredPlaneManifold manifold;
    const TangentBlocks blocks = {{block}, {&manifold}};
    Eigen::VectorXd r;
    const Eigen::MatrixXd j = TangentJacobian(cost, blocks, &r);
    EXPECT_LT((j - DifferenceJacobian(cost, blocks, 1e-5)).norm(),
              1e-6 * j.norm());
  }
}

// Perfectly flat clusters have a singular moment matrix. Breaks by sqrt of a
// negative eigenvalue.
TEST(PlaneMomentCost, FlatClusterIsZeroOnItsPlane) {
  Random random(2);
  Eigen::Matrix4d moment = Eigen::Matrix4d::Zero();
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector4d m(random.Normal(), random.Normal(), 0, 1);
    moment += m * m.transpose();
  }
  const PlaneMomentCost cost(moment, 1);
  EXPECT_NEAR(Residuals(cost, {{0, 0, 1, 0}}).norm(), 0, 1e-7);
  EXPECT_NEAR(Residuals(cost, {{0, 0, 1, 0.1}}).squaredNorm(), 50 * 0.01, 1e-9);
}

// E_d from 4x4 moments equals the weighted sum over the samples, for any pose
// and plane. Breaks if the plane is taken to the camera with T^-1, or if the
// anchor is forgotten.
TEST(DepthMomentCost, EqualsTheSumOverTheSamples) {
  Random random(7);
  for (int trial = 0; trial < 20; ++trial) {
    const std::vector<double> pose = MakePhotoScene(1, &random).pose;
    const Eigen::Vector3d anchor = 2 * RandomVector(&random);
    const Eigen::Vector3d n = RandomVector(&random).normalized();
    const std::vector<double> plane = {n.x(), n.y(), n.z(), 0.1};
    const Pose world_from_cam = PoseFromBlock(pose.data()).Inverse();
    Eigen::Matrix4d moment = Eigen::Matrix4d::Zero();
    double expected = 0;
    for (int i = 0; i < 100; ++i) {
      const Eigen::Vector3d x = 3 * RandomVector(&random);
      const double weight = 1 + i % 5;
      const Eigen::Vector4d m = x.homogeneous();
      moment += weight * m * m.transpose();
      const double distance = n.dot(world_from_cam * x - anchor) + 0.1;
      expected += weight * distance * distance;
    }
    const std::unique_ptr<ceres::CostFunction> cost(
        DepthMomentCost::Create(moment, anchor, 0.5));
    EXPECT_NEAR(Residuals(*cost, {pose, plane}).squaredNorm(),
                0.5 * expected,
                1e-9 * expected);
    const LeftSe3Manifold poses;
    const AnchoredPlaneManifold planes;
    const TangentBlocks blocks = {{pose, plane}, {&poses, &planes}};
    Eigen::VectorXd r;
    const Eigen::MatrixXd j = TangentJacobian(*cost, blocks, &r);
    EXPECT_LT((j - DifferenceJacobian(*cost, blocks, 1e-5)).norm(),
              1e-6 * j.norm());
  }
}

// Breaks if the prior pulls away from the given poses.
TEST(PosePriorCost, IsZeroAtItsCentreForEitherSignOfTheQuaternion) {
  Random random(3);
  std::vector<double> pose = MakePhotoScene(1, &random).pose;
  const std::unique_ptr<ceres::CostFunction> cost(
      PosePriorCost::Create(PoseFromBlock(pose.data()), {}));
  EXPECT_LT(Residuals(*cost, {pose}).norm(), 1e-10);
  for (int k = 0; k < 4; ++k) pose[k] = -pose[k];
  EXPECT_LT(Residuals(*cost, {pose}).norm(), 1e-10);
}

// One sigma of rotation or translation costs sigma_I^2. Breaks if degrees,
// weights or the order of T T_0^-1 are wrong.
TEST(PosePriorCost, OneSigmaCostsTheSquaredIntensitySigma) {
  Random random(4);
  const Pose initial = PoseFromBlock(MakePhotoScene(1, &random).pose.data());
  const PosePriorSigmas sigmas = {0.005, 0.02, 0.03};
  const std::unique_ptr<ceres::CostFunction> cost(
      PosePriorCost::Create(initial, sigmas));
  const Eigen::Vector3d direction = RandomVector(&random).normalized();
  Vector6d turn = Vector6d::Zero(), shift = Vector6d::Zero();
  turn.head<3>() = 0.005 * direction;
  shift.tail<3>() = 0.02 * direction;
  for (const Vector6d& xi : {turn, shift}) {
    std::vector<double> pose(kPoseSize);
    PoseToBlock(ExpSe3(xi) * initial, pose.data());
    EXPECT_NEAR(Residuals(*cost, {pose}).squaredNorm(), 0.03 * 0.03, 1e-12);
  }
}

// T_i -> T_i G, T_i0 -> T_i0 G: the prior must not see where the world is.
TEST(PosePriorCost, DoesNotDependOnTheWorldFrame) {
  Random random(5);
  const Pose initial = PoseFromBlock(MakePhotoScene(1, &random).pose.data());
  Vector6d xi;
  xi << 0.01, -0.02, 0.03, 0.02, 0.01, -0.01;
  const Pose world_change =
      PoseFromBlock(MakePhotoScene(1, &random).pose.data());
  Eigen::VectorXd r[2];
  for (const int moved : {0, 1}) {
    const Pose center = moved ? initial * world_change : initial;
    const std::unique_ptr<ceres::CostFunction> cost(
        PosePriorCost::Create(center, {}));
    std::vector<double> pose(kPoseSize);
    PoseToBlock(ExpSe3(xi) * center, pose.data());
    r[moved] = Residuals(*cost, {pose});
  }
  EXPECT_LT((r[0] - r[1]).norm(), 1e-10 * r[0].norm());
}

// At random states and at the centre itself, where the rotation vector is 0/0.
TEST(PosePriorCost, GradientIsExact) {
  Random random(6);
  const LeftSe3Manifold manifold;
  for (int trial = 0; trial < 100; ++trial) {
    const Pose initial = PoseFromBlock(MakePhotoScene(1, &random).pose.data());
    const std::unique_ptr<ceres::CostFunction> cost(
        PosePriorCost::Create(initial, {}));
    Vector6d xi;
    xi << 0.1 * RandomVector(&random), 0.1 * RandomVector(&random);
    if (trial == 0) xi.setZero();
    std::vector<double> pose(kPoseSize);
    PoseToBlock(ExpSe3(xi) * initial, pose.data());
    const TangentBlocks blocks = {{pose}, {&manifold}};
    Eigen::VectorXd r;
    const Eigen::MatrixXd jacobian = TangentJacobian(*cost, blocks, &r);
    ASSERT_TRUE(jacobian.allFinite());
    EXPECT_LT((jacobian - DifferenceJacobian(*cost, blocks, 1e-5)).norm(),
              1e-6 * jacobian.norm());
  }
}

TEST(WarpOffsetCost, IsTheVectorItself) {
  const std::unique_ptr<ceres::CostFunction> cost(WarpOffsetCost::Create());
  const TangentBlocks blocks = {{{1.5, -2}}, {nullptr}};
  Eigen::VectorXd r;
  EXPECT_EQ(TangentJacobian(*cost, blocks, &r), Eigen::Matrix2d::Identity());
  EXPECT_EQ(r, Eigen::Vector2d(1.5, -2));
}

}  // namespace
}  // namespace facet
