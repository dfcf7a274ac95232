// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "mesh/quadric.h"

#include <gtest/gtest.h>

#include "util/random.h"

namespace facet {
namespace {

Eigen::Vector3d RandomPoint(Random* random) {
  return {
      random->Uniform(-1, 1), random->Uniform(-1, 1), random->Uniform(-1, 1)};
}

// Breaks if a coefficient of one of the three basic quadrics is wrong.
TEST(Quadric, IsTheWeightedSquaredDistance) {
  Random random(1);
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector3d p = RandomPoint(&random), v = RandomPoint(&random);
    const Eigen::Vector3d n = RandomPoint(&random).normalized();
    const double w = random.Uniform(0.1, 2);
    const double along = n.dot(v - p);
    EXPECT_NEAR(Quadric::Plane(n, -n.dot(p), w)(v), w * along * along, 1e-12);
    EXPECT_NEAR(Quadric::Line(p, n, w)(v),
                w * ((v - p).squaredNorm() - along * along),
                1e-12);
    EXPECT_NEAR(Quadric::Point(p, w)(v), w * (v - p).squaredNorm(), 1e-12);
    const Quadric sum = Quadric::Plane(n, 0.3, w) + Quadric::Line(p, n, 1);
    EXPECT_NEAR(sum(v),
                Quadric::Plane(n, 0.3, w)(v) + Quadric::Line(p, n, 1)(v),
                1e-12);
  }
}

// Breaks if the closed solution of the 3x3 system is wrong: three planes meet
// in one point, and no step lowers the cost.
TEST(Quadric, MinimumIsWherePlanesMeet) {
  Random random(2);
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector3d p = RandomPoint(&random);
    Quadric q;
    for (int k = 0; k < 3; ++k) {
      Eigen::Vector3d n = Eigen::Vector3d::Unit(k) + 0.3 * RandomPoint(&random);
      n.normalize();
      q += Quadric::Plane(n, -n.dot(p), random.Uniform(0.5, 2));
    }
    Eigen::Vector3d best;
    ASSERT_TRUE(q.Minimum(&best));
    EXPECT_LT((best - p).norm(), 1e-9);
  }
}

// Breaks if a singular system is solved anyway.
TEST(Quadric, NoMinimumOnAPlaneOrLine) {
  Eigen::Vector3d v(7, 8, 9);
  const Eigen::Vector3d n = Eigen::Vector3d(1, 2, 3).normalized();
  EXPECT_FALSE(Quadric::Plane(n, 1, 1).Minimum(&v));
  EXPECT_FALSE(Quadric::Line(n, n, 1).Minimum(&v));
  EXPECT_FALSE(Quadric().Minimum(&v));
  EXPECT_EQ(v, Eigen::Vector3d(7, 8, 9));
}

}  // namespace
}  // namespace facet
