// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include <ceres/manifold_test_utils.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>

#include "costs/plane_manifold.h"
#include "costs/se3_manifold.h"
#include "util/random.h"

namespace facet {
namespace {

// The macro of Ceres 2.1 does not qualify its names.
using namespace ceres;  // NOLINT

Vector RandomVectorOf(int n, double scale, Random* random) {
  Vector v(n);
  for (int i = 0; i < n; ++i) v[i] = scale * random->Normal();
  return v;
}

Vector RandomPose(Random* random) {
  Vector6d xi = RandomVectorOf(6, 1.0, random);
  xi.tail<3>() *= 3;
  Vector x(kPoseSize);
  PoseToBlock(ExpSe3(xi), x.data());
  return x;
}

// Breaks if Plus, Minus and their Jacobians do not belong together.
TEST(LeftSe3Manifold, InvariantsHold) {
  Random random(1);
  const LeftSe3Manifold manifold;
  for (int i = 0; i < 20; ++i) {
    const Vector x = RandomPose(&random);
    const Vector delta = RandomVectorOf(6, 0.5, &random);
    // y on x's side of the quaternion sphere: q and -q are the same rotation,
    // and Plus(x, Minus(y, x)) gives the nearer one.
    Vector y(kPoseSize);
    const Vector step = RandomVectorOf(6, 0.5, &random);
    manifold.Plus(x.data(), step.data(), y.data());
    EXPECT_THAT_MANIFOLD_INVARIANTS_HOLD(manifold, x, delta, y, 1e-8);
  }
}

// Breaks if the increment is applied from the right, or (omega, upsilon) are
// swapped: the formulas of the kernel's pose columns assume this one.
TEST(LeftSe3Manifold, IncrementMultipliesFromTheLeft) {
  Random random(2);
  const Vector x = RandomPose(&random);
  const Vector6d xi = RandomVectorOf(6, 0.3, &random);
  Vector y(kPoseSize);
  LeftSe3Manifold().Plus(x.data(), xi.data(), y.data());
  const Pose expected = ExpSe3(xi) * PoseFromBlock(x.data());
  EXPECT_LT((PoseFromBlock(y.data()).Matrix() - expected.Matrix()).norm(),
            1e-12);
}

// J = J_xi * lift, and Ceres computes J * P: breaks if that is not J_xi.
TEST(LeftSe3Manifold, LiftedRowsComeBackInTheTangentSpace) {
  Random random(3);
  for (int i = 0; i < 20; ++i) {
    const Vector x = RandomPose(&random);
    Eigen::Matrix<double, kPoseSize, 6, Eigen::RowMajor> p;
    LeftSe3Manifold().PlusJacobian(x.data(), p.data());
    EXPECT_LT(
        (LeftPoseLift(x.data()) * p - Eigen::Matrix<double, 6, 6>::Identity())
            .norm(),
        1e-12);
  }
}

constexpr PoseKind kPoseKinds[] = {
    PoseKind::kLeft, PoseKind::kRight, PoseKind::kQuaternion};

// Ceres's own list: Plus and Minus undo each other, both Jacobians are their
// derivatives.
TEST(PoseManifolds, InvariantsHold) {
  Random random(5);
  for (const PoseKind kind : kPoseKinds) {
    const std::unique_ptr<Manifold> manifold(CreatePoseManifold(kind));
    ASSERT_EQ(manifold->AmbientSize(), kPoseSize);
    ASSERT_EQ(manifold->TangentSize(), 6);
    for (int i = 0; i < 20; ++i) {
      const Vector x = RandomPose(&random);
      const Vector delta = RandomVectorOf(6, 0.5, &random);
      Vector y(kPoseSize);
      const Vector step = RandomVectorOf(6, 0.5, &random);
      manifold->Plus(x.data(), step.data(), y.data());
      EXPECT_THAT_MANIFOLD_INVARIANTS_HOLD((*manifold), x, delta, y, 1e-8);
    }
  }
}

// What lets one cost serve all: the PlusJacobian of every manifold lies in the
// range of the left one. Breaks if a manifold leaves the unit quaternions.
TEST(PoseManifolds, ShareTheTangentSpaceOfTheLeftOne) {
  Random random(6);
  for (const PoseKind kind : kPoseKinds) {
    const std::unique_ptr<Manifold> manifold(CreatePoseManifold(kind));
    const Vector x = RandomPose(&random);
    Eigen::Matrix<double, kPoseSize, 6, Eigen::RowMajor> p, left;
    manifold->PlusJacobian(x.data(), p.data());
    LeftSe3Manifold().PlusJacobian(x.data(), left.data());
    EXPECT_LT((left * (LeftPoseLift(x.data()) * p) - p).norm(), 1e-12);
  }
}

// Breaks if the right increment acts on camera coordinates.
TEST(PoseManifolds, RightIncrementMultipliesFromTheRight) {
  Random random(7);
  const Vector x = RandomPose(&random);
  const Vector6d xi = RandomVectorOf(6, 0.3, &random);
  Vector y(kPoseSize);
  RightSe3Manifold().Plus(x.data(), xi.data(), y.data());
  const Pose expected = PoseFromBlock(x.data()) * ExpSe3(xi);
  EXPECT_LT((PoseFromBlock(y.data()).Matrix() - expected.Matrix()).norm(),
            1e-12);
}

Vector RandomPlane(Random* random) {
  Vector x = RandomVectorOf(4, 1.0, random);
  x.head<3>().normalize();
  return x;
}

// Breaks if normal and offset change places in the block, if a shift to the
// origin is not undone, or if a Jacobian forgets it.
TEST(PlaneManifolds, InvariantsHoldAndNormalsStayUnit) {
  Random random(4);
  for (const PlaneKind kind : {PlaneKind::kAnchored,
                               PlaneKind::kRaw4,
                               PlaneKind::kOrigin,
                               PlaneKind::kUnit4}) {
    const Eigen::Vector3d anchor = RandomVectorOf(3, 3.0, &random);
    const std::unique_ptr<Manifold> manifold(CreatePlaneManifold(kind, anchor));
    ASSERT_EQ(manifold->AmbientSize(), kPlaneSize);
    ASSERT_EQ(manifold->TangentSize(), kind == PlaneKind::kRaw4 ? 4 : 3);
    for (int i = 0; i < 20; ++i) {
      const Vector x = RandomPlane(&random);
      Vector y = RandomPlane(&random);
      // Small enough that the unit 4-vector does not pass the plane at
      // infinity.
      const Vector delta =
          RandomVectorOf(manifold->TangentSize(), 0.03, &random);
      EXPECT_THAT_MANIFOLD_INVARIANTS_HOLD((*manifold), x, delta, y, 1e-7);
      manifold->Plus(x.data(), delta.data(), y.data());
      if (kind == PlaneKind::kRaw4) continue;
      EXPECT_NEAR(y.head<3>().norm(), 1, 1e-12);
    }
  }
}

// Four numbers for three degrees of freedom: all invariants but those that need
// Plus to be invertible, and the null vector (n, w).
TEST(PlaneManifolds, NormalisedFourNumbersHaveOneIdleDirection) {
  Random random(8);
  const Eigen::Vector3d anchor = RandomVectorOf(3, 3.0, &random);
  const std::unique_ptr<Manifold> manifold(
      CreatePlaneManifold(PlaneKind::kNormalised4, anchor));
  for (int i = 0; i < 20; ++i) {
    const Vector x = RandomPlane(&random), y = RandomPlane(&random);
    EXPECT_THAT(*manifold, XPlusZeroIsXAt(x, 1e-9));
    EXPECT_THAT(*manifold, XMinusXIsZeroAt(x, 1e-9));
    EXPECT_THAT(*manifold, PlusMinusIsIdentityAt(x, y, 1e-9));
    EXPECT_THAT(*manifold, HasCorrectPlusJacobianAt(x, 1e-7));
    EXPECT_THAT(*manifold, HasCorrectMinusJacobianAt(x, 1e-7));
    Eigen::Matrix<double, 4, 4, Eigen::RowMajor> p;
    manifold->PlusJacobian(x.data(), p.data());
    Vector idle = x;
    idle[3] = x[3] - x.head<3>().dot(anchor);
    EXPECT_LT((p * idle).norm(), 1e-9 * idle.norm());
    Eigen::FullPivLU<Eigen::Matrix4d> lu(p);
    lu.setThreshold(1e-9);
    EXPECT_EQ(lu.rank(), 3);
  }
}

// d is the distance of the anchor, w that of the origin: breaks if a step in
// the offset turns the plane, or if "origin" tilts about the anchor.
TEST(PlaneManifolds, TiltsAboutItsOwnPoint) {
  Random random(9);
  const Eigen::Vector3d anchor = RandomVectorOf(3, 3.0, &random);
  const Vector x = RandomPlane(&random);
  for (const PlaneKind kind : {PlaneKind::kAnchored, PlaneKind::kOrigin}) {
    const std::unique_ptr<Manifold> manifold(CreatePlaneManifold(kind, anchor));
    Vector y(4);
    const double delta[3] = {0.02, -0.01, 0.005};
    manifold->Plus(x.data(), delta, y.data());
    const double d = y[3] - x[3];
    const double w = d - (y - x).head<3>().dot(anchor);
    EXPECT_NEAR(kind == PlaneKind::kAnchored ? d : w, 0.005, 1e-12);
    EXPECT_GT((y - x).head<3>().norm(), 0.005);
  }
}

}  // namespace
}  // namespace facet
