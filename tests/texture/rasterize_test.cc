// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "texture/rasterize.h"

#include <gtest/gtest.h>

#include <cmath>

#include "texture/charts.h"
#include "util/random.h"

namespace facet {
namespace {

using Eigen::Vector2d;

TEST(Rasterize, NeighboursShareNoTexelAndLeaveNone) {
  // A fan of random triangles fills a square: every centre inside it must be
  // owned exactly once. Fails for any sloppy edge rule or float edge function.
  Random random(1);
  for (int trial = 0; trial < 20; ++trial) {
    std::vector<int> owners(40 * 40, 0);
    const Vector2d hub(random.Uniform(5, 35), random.Uniform(5, 35));
    std::vector<Vector2d> ring;
    for (int side = 0; side < 4; ++side) {
      for (int i = 0; i < 6; ++i) {
        const double t = 40.0 * i / 6;
        ring.push_back(side == 0   ? Vector2d(t, 0)
                       : side == 1 ? Vector2d(40, t)
                       : side == 2 ? Vector2d(40 - t, 40)
                                   : Vector2d(0, 40 - t));
      }
    }
    for (size_t i = 0; i < ring.size(); ++i) {
      UvTriangle uv = {hub, ring[i], ring[(i + 1) % ring.size()]};
      if (trial % 2) std::swap(uv[0], uv[2]);  // either orientation
      RasterizeTriangle(
          uv, 40, 40, [&](int c, int r) { ++owners[r * 40 + c]; });
    }
    for (int count : owners) ASSERT_EQ(count, 1);
  }
}

TEST(Rasterize, CentresOnEdgesBelongToOneSide) {
  // Vertices and diagonals exactly on texel centres: the tie-break decides.
  std::vector<int> owners(100, 0);
  const auto count = [&](int c, int r) { ++owners[r * 10 + c]; };
  const Vector2d a(0.5, 0.5), b(9.5, 0.5), c(9.5, 9.5), d(0.5, 9.5);
  RasterizeTriangle({a, b, c}, 10, 10, count);
  RasterizeTriangle({a, c, d}, 10, 10, count);
  int sum = 0;
  for (int n : owners) {
    EXPECT_LE(n, 1);
    sum += n;
  }
  EXPECT_EQ(sum, 81);  // 9 px x 9 px of area, exactly
}

TEST(Charts, MinAreaRectangleFollowsAnyRotation) {
  // A box of points turned by an angle: the axis must be one of its sides.
  Random random(2);
  for (double angle : {0.0, 0.3, 1.0, 2.2}) {
    const Eigen::Rotation2Dd turn(angle);
    std::vector<Vector2d> points;
    for (int i = 0; i < 200; ++i) {
      points.push_back(turn *
                       Vector2d(random.Uniform(-3, 3), random.Uniform(-1, 1)));
    }
    for (double x : {-3, 3}) {
      for (double y : {-1, 1}) points.push_back(turn * Vector2d(x, y));
    }
    const Vector2d axis = turn.inverse() * MinAreaRectangleAxis(points);
    EXPECT_NEAR(axis.norm(), 1, 1e-12);
    EXPECT_NEAR(std::abs(axis.x() * axis.y()), 0, 1e-9);
  }
}

}  // namespace
}  // namespace facet
