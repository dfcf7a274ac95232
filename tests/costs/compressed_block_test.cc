// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "costs/compressed_block.h"

#include <gtest/gtest.h>

#include <Eigen/Core>

#include "util/random.h"

namespace facet {
namespace {

using RowMajor =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

Eigen::MatrixXd RandomMatrix(int rows, int cols, Random* random) {
  Eigen::MatrixXd m(rows, cols);
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < cols; ++j) m(i, j) = random->Normal();
  }
  return m;
}

struct Compressed {
  Eigen::MatrixXd rows;
  Eigen::VectorXd residuals;
};

Compressed Compress(const RowMajor& gram) {
  const int n = static_cast<int>(gram.rows()) - 1;
  RowMajor rows(n + 1, n);
  Compressed c;
  c.residuals.resize(n + 1);
  CompressGram(n, gram.data(), rows.data(), c.residuals.data());
  c.rows = rows;
  return c;
}

// [J r]^T [J r], upper triangle only: the lower one must not be read.
RowMajor Gram(const Eigen::MatrixXd& j, const Eigen::VectorXd& r) {
  Eigen::MatrixXd jr(j.rows(), j.cols() + 1);
  jr << j, r;
  RowMajor gram = jr.transpose() * jr;
  gram.triangularView<Eigen::StrictlyLower>().setConstant(1e9);
  return gram;
}

// The triple that a least-squares solver sees. Errors are relative to the
// natural scales |J_i||J_j|, |J_i||r|, r^T r.
void ExpectSameTriple(const Eigen::MatrixXd& j,
                      const Eigen::VectorXd& r,
                      const Compressed& c,
                      double tolerance) {
  ASSERT_TRUE(c.rows.allFinite());
  ASSERT_TRUE(c.residuals.allFinite());
  Eigen::MatrixXd expected = j.transpose() * j;
  expected.diagonal() *= 1 + kGramShift;
  const Eigen::VectorXd scale = j.colwise().norm();
  const Eigen::MatrixXd hessian = c.rows.transpose() * c.rows;
  const Eigen::VectorXd gradient = c.rows.transpose() * c.residuals;
  for (int i = 0; i < j.cols(); ++i) {
    EXPECT_NEAR(gradient[i], j.col(i).dot(r), tolerance * scale[i] * r.norm());
    for (int k = 0; k < j.cols(); ++k) {
      EXPECT_NEAR(
          hessian(i, k), expected(i, k), tolerance * scale[i] * scale[k]);
    }
  }
  EXPECT_NEAR(
      c.residuals.squaredNorm(), r.squaredNorm(), tolerance * r.squaredNorm());
}

// Breaks if the factorisation is wrong in any entry: cost, gradient and Hessian
// of N residuals must survive in n + 1 rows.
TEST(CompressGram, KeepsCostGradientAndHessian) {
  Random random(1);
  for (const int n : {1, 4, 6, 14, 32}) {
    // Columns of very different size, as rotations and translations have.
    Eigen::MatrixXd j = RandomMatrix(200, n, &random);
    for (int i = 0; i < n; ++i) j.col(i) *= std::pow(10.0, i % 5 - 2);
    const Eigen::VectorXd r = RandomMatrix(200, 1, &random);
    ExpectSameTriple(j, r, Compress(Gram(j, r)), 1e-9);
  }
}

// Dependent columns (pose against constant warp) and columns without any
// gradient (warp vertices in a blank part). Breaks if a skipped pivot loses
// cost or gradient, or divides by zero.
TEST(CompressGram, SurvivesDependentAndZeroColumns) {
  Random random(2);
  Eigen::MatrixXd j =
      RandomMatrix(100, 5, &random) * RandomMatrix(5, 14, &random);
  j.col(3).setZero();
  j.col(13).setZero();
  j.col(0).setZero();
  const Eigen::VectorXd r = RandomMatrix(100, 1, &random);
  const Compressed c = Compress(Gram(j, r));
  ExpectSameTriple(j, r, c, 1e-7);
  for (const int zero : {0, 3, 13}) {
    EXPECT_EQ(c.rows.row(zero).norm(), 0);
    EXPECT_EQ(c.residuals[zero], 0);
  }
}

// Fewer residuals than parameters, and residuals that the step removes wholly.
TEST(CompressGram, SurvivesFewResidualsAndExactFits) {
  Random random(3);
  const Eigen::MatrixXd j = RandomMatrix(3, 14, &random);
  const Eigen::VectorXd r = j * RandomMatrix(14, 1, &random);
  ExpectSameTriple(j, r, Compress(Gram(j, r)), 1e-7);
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(3);
  ExpectSameTriple(j, zero, Compress(Gram(j, zero)), 1e-7);
}

// The trap (docs/design.md): a Gram matrix that was summed in float is
// indefinite by rounding. A factor that skips small pivots then reports a wrong
// cost that still looks plausible. Tolerance: float rounding of the sums
// (6e-8) over the square root of the shift (2e-3).
TEST(CompressGram, SurvivesGramMatricesRoundedToFloat) {
  Random random(4);
  for (int trial = 0; trial < 50; ++trial) {
    Eigen::MatrixXd j =
        RandomMatrix(300, 4, &random) * RandomMatrix(4, 14, &random);
    for (int i = 0; i < 14; ++i) j.col(i) *= std::pow(10.0, i % 5 - 2);
    const Eigen::VectorXd r = RandomMatrix(300, 1, &random);
    const RowMajor gram = Gram(j, r).cast<float>().cast<double>();
    ExpectSameTriple(j, r, Compress(gram), 3e-5);
  }
}

}  // namespace
}  // namespace facet
