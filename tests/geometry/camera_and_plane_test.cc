// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "geometry/pinhole.h"
#include "geometry/plane.h"
#include "util/random.h"

namespace facet {
namespace {

Eigen::Vector3d RandomVector(Random* random) {
  const double x = random->Normal(), y = random->Normal();
  return {x, y, random->Normal()};
}

// Breaks if f or c of the two axes are mixed up.
TEST(Pinhole, UnprojectIsTheInverseOfProject) {
  const Pinhole camera = {520, 530, 321, 238, 640, 480};
  for (const double u : {0.0, 100.5, 639.0}) {
    for (const double v : {0.0, 77.25, 479.0}) {
      const Eigen::Vector3d ray = camera.Unproject(u, v);
      EXPECT_EQ(ray.z(), 1);
      const Eigen::Vector2d back = camera.Project<double>(2.5 * ray);
      EXPECT_NEAR(back.x(), u, 1e-10);
      EXPECT_NEAR(back.y(), v, 1e-10);
    }
  }
}

// A pixel of level l covers 2^l x 2^l pixels: its centre is the mean of theirs,
// u_0 = 2^l (u_l + 0.5) - 0.5. Breaks if the half pixel is forgotten.
TEST(Pinhole, LevelsSeeTheSamePointInTheMiddleOfTheirPixels) {
  const Pinhole camera = {520, 530, 321, 238, 640, 480};
  Random random(1);
  for (const int level : {0, 1, 2, 3}) {
    const Pinhole coarse = camera.Level(level);
    EXPECT_EQ(coarse.width, 640 >> level);
    EXPECT_EQ(coarse.height, 480 >> level);
    Eigen::Vector3d y = RandomVector(&random);
    y.z() = 2;
    const Eigen::Vector2d fine = camera.Project<double>(y);
    const Eigen::Vector2d u = coarse.Project<double>(y);
    const double s = 1 << level;
    EXPECT_NEAR(s * (u.x() + 0.5) - 0.5, fine.x(), 1e-10);
    EXPECT_NEAR(s * (u.y() + 0.5) - 0.5, fine.y(), 1e-10);
  }
}

// Breaks if the last pixel centre is taken for width instead of width - 1.
TEST(Pinhole, ContainsCountsFromTheOutermostPixelCentres) {
  const Pinhole camera = {100, 100, 50, 40, 101, 81};
  EXPECT_TRUE(camera.Contains({0, 0}));
  EXPECT_TRUE(camera.Contains({100, 80}));
  EXPECT_FALSE(camera.Contains({100.01, 80}));
  EXPECT_FALSE(camera.Contains({100, 80.01}));
  EXPECT_TRUE(camera.Contains({5, 75}, 5));
  EXPECT_FALSE(camera.Contains({4.9, 75}, 5));
}

// Breaks if q does not lie on the plane, is not the nearest point, or if the
// anchored form (n, d, c) means another plane than (n, w = d - n.c).
TEST(Plane, ProjectionIsIdempotentNearestAndIndependentOfTheAnchor) {
  Random random(2);
  for (int i = 0; i < 50; ++i) {
    Plane plane;
    plane.normal = RandomVector(&random).normalized();
    plane.offset = random.Normal();
    const Eigen::Vector3d p = RandomVector(&random);
    const Eigen::Vector3d anchor = 10 * RandomVector(&random);
    const double block[4] = {plane.normal.x(),
                             plane.normal.y(),
                             plane.normal.z(),
                             plane.SignedDistance(anchor)};
    const Eigen::Vector3d q = ProjectOntoPlane(block, p, anchor);
    EXPECT_NEAR(plane.SignedDistance(q), 0, 1e-13);
    EXPECT_LT((q - plane.Project(p)).norm(), 1e-13);
    EXPECT_LT((ProjectOntoPlane(block, q, anchor) - q).norm(), 1e-13);
    EXPECT_NEAR((p - q).norm(), std::abs(plane.SignedDistance(p)), 1e-13);
  }
}

}  // namespace
}  // namespace facet
