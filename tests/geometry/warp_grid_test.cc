// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "geometry/warp_grid.h"

#include <gtest/gtest.h>

#include <vector>

#include "util/random.h"

namespace facet {
namespace {

const WarpLattice kLattice = {20, 16, 640, 480};

std::vector<double> RandomField(uint64_t seed) {
  Random random(seed);
  std::vector<double> f(2 * kLattice.NumVertices());
  for (double& x : f) x = random.Normal();
  return f;
}

// 6 + 640 unknowns a frame, as published.
TEST(WarpLattice, HasThePublishedNumberOfUnknowns) {
  EXPECT_EQ(2 * kLattice.NumVertices(), 640);
  EXPECT_EQ(kLattice.NumCells(), 19 * 15);
}

// Breaks if a weight is missing: a constant field must move every pixel by the
// constant (sum of the delta_l = 1), inside and outside of the image.
TEST(WarpLattice, WeightsSumToOne) {
  std::vector<double> f;
  for (int l = 0; l < kLattice.NumVertices(); ++l) {
    f.push_back(1.25);
    f.push_back(-0.5);
  }
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector2d u(random.Uniform(-20, 660), random.Uniform(-20, 500));
    const Eigen::Vector2d moved = kLattice.Apply(f.data(), u) - u;
    EXPECT_NEAR(moved.x(), 1.25, 1e-12);
    EXPECT_NEAR(moved.y(), -0.5, 1e-12);
  }
}

// E_s = 0 means F = identity.
TEST(WarpLattice, ZeroFieldIsTheIdentity) {
  const std::vector<double> f(2 * kLattice.NumVertices(), 0.0);
  const Eigen::Vector2d u(123.4, 56.7);
  EXPECT_EQ(kLattice.Apply(f.data(), u), u);
}

// delta_l is 1 at its own vertex: the outer ones lie on the centres of the
// outermost pixels. Breaks if cell sizes or the row order are wrong.
TEST(WarpLattice, VerticesMoveByTheirOwnVector) {
  const std::vector<double> f = RandomField(2);
  for (int row = 0; row < kLattice.rows; ++row) {
    for (int column = 0; column < kLattice.columns; ++column) {
      const Eigen::Vector2d u(639.0 * column / 19, 479.0 * row / 15);
      const double* own = f.data() + 2 * kLattice.VertexIndex(column, row);
      const Eigen::Vector2d moved = kLattice.Apply(f.data(), u) - u;
      EXPECT_NEAR(moved.x(), own[0], 1e-9);
      EXPECT_NEAR(moved.y(), own[1], 1e-9);
    }
  }
}

// A field that is linear in u must be reproduced. Breaks if alpha and beta are
// swapped.
TEST(WarpLattice, ReproducesAffineFields) {
  std::vector<double> f(2 * kLattice.NumVertices());
  const auto field = [](double u, double v) {
    return Eigen::Vector2d(0.01 * u - 0.02 * v + 1, 0.03 * u + 0.005 * v - 2);
  };
  for (int row = 0; row < kLattice.rows; ++row) {
    for (int column = 0; column < kLattice.columns; ++column) {
      const Eigen::Vector2d x =
          field(column * kLattice.CellWidth(), row * kLattice.CellHeight());
      f[2 * kLattice.VertexIndex(column, row)] = x.x();
      f[2 * kLattice.VertexIndex(column, row) + 1] = x.y();
    }
  }
  Random random(3);
  for (int i = 0; i < 100; ++i) {
    const Eigen::Vector2d u(random.Uniform(-20, 660), random.Uniform(-20, 500));
    EXPECT_LT((kLattice.Apply(f.data(), u) - u - field(u.x(), u.y())).norm(),
              1e-10);
  }
}

// Breaks if neighbouring cells disagree on their common border.
TEST(WarpLattice, IsContinuousOverCellBorders) {
  const std::vector<double> f = RandomField(4);
  Random random(5);
  for (int i = 0; i < 100; ++i) {
    const double border = kLattice.CellWidth() * (1 + random.Index(18));
    const double v = random.Uniform(0, 479);
    const Eigen::Vector2d left = kLattice.Apply(f.data(), {border - 1e-9, v});
    const Eigen::Vector2d right = kLattice.Apply(f.data(), {border + 1e-9, v});
    EXPECT_LT((left - right).norm(), 1e-8);
    const double border_v = kLattice.CellHeight() * (1 + random.Index(14));
    const double u = random.Uniform(0, 639);
    EXPECT_LT((kLattice.Apply(f.data(), {u, border_v - 1e-9}) -
               kLattice.Apply(f.data(), {u, border_v + 1e-9}))
                  .norm(),
              1e-8);
  }
}

}  // namespace
}  // namespace facet
