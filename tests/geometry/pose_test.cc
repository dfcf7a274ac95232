// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "geometry/pose.h"

#include <gtest/gtest.h>

#include "util/random.h"

namespace facet {
namespace {

Eigen::Vector3d RandomVector(Random* random) {
  const double x = random->Normal(), y = random->Normal();
  return {x, y, random->Normal()};
}

Vector6d RandomTwist(double angle, Random* random) {
  Vector6d xi;
  xi << angle * RandomVector(random).normalized(), RandomVector(random);
  return xi;
}

// exp of the 4x4 twist matrix by its power series with scaling and squaring: an
// independent way to the same transform.
Eigen::Matrix4d MatrixExponential(const Vector6d& xi) {
  Eigen::Matrix4d a = Eigen::Matrix4d::Zero();
  a.topLeftCorner<3, 3>() = Skew(xi.head<3>());
  a.topRightCorner<3, 1>() = xi.tail<3>();
  a /= 64;
  Eigen::Matrix4d term = Eigen::Matrix4d::Identity(), sum = term;
  for (int n = 1; n < 15; ++n) {
    term = term * a / n;
    sum += term;
  }
  for (int n = 0; n < 6; ++n) sum = sum * sum;
  return sum;
}

// Small, ordinary and nearly full half turns: every branch of Exp and Log.
const double kAngles[] = {0,
                          1e-12,
                          1e-9,
                          0.9e-6,
                          1.1e-6,
                          0.9e-4,
                          1.1e-4,
                          1e-3,
                          0.3,
                          1.5,
                          3.0,
                          3.1415};

// Breaks if V and V^-1 do not belong together or a series is cut too early.
TEST(Se3, LogIsTheInverseOfExp) {
  Random random(1);
  for (const double angle : kAngles) {
    for (int i = 0; i < 20; ++i) {
      const Vector6d xi = RandomTwist(angle, &random);
      EXPECT_LT((LogSe3(ExpSe3(xi)) - xi).norm(), 1e-10) << angle;
    }
  }
}

// Breaks if Log(Exp) is the identity only because both share a mistake.
TEST(Se3, ExpIsTheMatrixExponential) {
  Random random(2);
  for (const double angle : kAngles) {
    const Vector6d xi = RandomTwist(angle, &random);
    EXPECT_LT((ExpSe3(xi).Matrix() - MatrixExponential(xi)).norm(), 1e-12)
        << angle;
  }
}

// q and -q are the same rotation. Breaks if Log takes the long way round.
TEST(Se3, LogIgnoresTheSignOfTheQuaternion) {
  Random random(3);
  Pose pose = ExpSe3(RandomTwist(0.5, &random));
  const Vector6d xi = LogSe3(pose);
  pose.rotation.coeffs() *= -1;
  EXPECT_LT((LogSe3(pose) - xi).norm(), 1e-12);
  EXPECT_NEAR(RotationAngle(pose), 0.5, 1e-12);
}

// Breaks if the order of a product is swapped: c_from_a = c_from_b * b_from_a.
TEST(Pose, ProductAppliesTheRightFactorFirst) {
  Random random(4);
  for (int i = 0; i < 20; ++i) {
    const Pose c_from_b = ExpSe3(RandomTwist(random.Uniform(0, 3), &random));
    const Pose b_from_a = ExpSe3(RandomTwist(random.Uniform(0, 3), &random));
    const Eigen::Vector3d x = RandomVector(&random);
    const Pose c_from_a = c_from_b * b_from_a;
    EXPECT_LT((c_from_a * x - c_from_b * (b_from_a * x)).norm(), 1e-12);
    EXPECT_LT(
        (c_from_a.Matrix() - c_from_b.Matrix() * b_from_a.Matrix()).norm(),
        1e-12);
    EXPECT_LT((c_from_a.Inverse() * (c_from_a * x) - x).norm(), 1e-12);
    EXPECT_LT((Pose(c_from_a.Matrix()).Matrix() - c_from_a.Matrix()).norm(),
              1e-12);
  }
}

// Breaks if the centre is confused with the translation.
TEST(Pose, CameraCentreMapsToTheCameraOrigin) {
  Random random(5);
  const Pose cam_from_world = ExpSe3(RandomTwist(1.2, &random));
  EXPECT_LT((cam_from_world * cam_from_world.CenterInSource()).norm(), 1e-12);
}

// y = T q changes by omega x y + upsilon: the definition of the left increment.
// Breaks if Exp is applied from the right or the twist order is swapped.
TEST(Se3, LeftIncrementMovesPointsAsDocumented) {
  Random random(6);
  const Pose t = ExpSe3(RandomTwist(0.8, &random));
  const Eigen::Vector3d q = RandomVector(&random), y = t * q;
  const Vector6d xi = 1e-6 * RandomTwist(1, &random);
  const Eigen::Vector3d moved = ExpSe3(xi) * t * q;
  const Eigen::Vector3d expected = y + xi.head<3>().cross(y) + xi.tail<3>();
  EXPECT_LT((moved - expected).norm(), 1e-11);
}

}  // namespace
}  // namespace facet
