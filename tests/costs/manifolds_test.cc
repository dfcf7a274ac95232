// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include <ceres/manifold_test_utils.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

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

// Breaks if normal and offset change places in the block.
TEST(AnchoredPlaneManifold, InvariantsHoldAndNormalsStayUnit) {
  Random random(4);
  const AnchoredPlaneManifold manifold;
  ASSERT_EQ(manifold.AmbientSize(), kPlaneSize);
  ASSERT_EQ(manifold.TangentSize(), 3);
  for (int i = 0; i < 20; ++i) {
    Vector x = RandomVectorOf(4, 1.0, &random);
    x.head<3>().normalize();
    Vector y = RandomVectorOf(4, 1.0, &random);
    y.head<3>().normalize();
    const Vector delta = RandomVectorOf(3, 0.5, &random);
    EXPECT_THAT_MANIFOLD_INVARIANTS_HOLD(manifold, x, delta, y, 1e-8);
    manifold.Plus(x.data(), delta.data(), y.data());
    EXPECT_NEAR(y.head<3>().norm(), 1, 1e-12);
    EXPECT_NEAR(y[3], x[3] + delta[2], 1e-12);
  }
}

}  // namespace
}  // namespace facet
