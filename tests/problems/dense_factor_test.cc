// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "problems/dense_factor.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <random>

#include "problems/block_product.h"
#include "util/parallel_for.h"

namespace facet {
namespace {

Eigen::MatrixXd Random(Eigen::Index rows, Eigen::Index cols, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  return Eigen::MatrixXd::NullaryExpr(
      rows, cols, [&] { return normal(random); });
}

Eigen::MatrixXd RandomPositive(Eigen::Index n, unsigned seed) {
  const Eigen::MatrixXd j = Random(2 * n, n, seed);
  return j.transpose() * j / static_cast<double>(n);
}

Eigen::MatrixXd Upper(const Eigen::MatrixXd& a) {
  return a.triangularView<Eigen::Upper>();
}

// Breaks when rows or columns at the end of a block are left out, or those of
// another block are taken: the sizes are beside and between the blocks.
TEST(DenseFactor, IsThatOfEigenAndKeepsTheMatrixBelow) {
  for (const Eigen::Index n : {1, 6, 59, 60, 61, 240, 300, 301, 361, 662}) {
    const Eigen::MatrixXd a = RandomPositive(n, 1);
    Eigen::MatrixXd factor = Upper(a);  // nothing below
    FactorUpper(1e-5, 1e-12, &factor);
    const Eigen::MatrixXd expected = a.llt().matrixU();
    EXPECT_LT((Upper(factor) - expected).norm(), 1e-12 * expected.norm()) << n;
    const Eigen::MatrixXd below =
        factor.triangularView<Eigen::StrictlyLower>().toDenseMatrix() -
        a.triangularView<Eigen::StrictlyLower>().toDenseMatrix();
    EXPECT_LT(below.norm(), 1e-12 * a.norm()) << n;
  }
}

// Breaks when a failed attempt leaves its traces in the matrix that the next
// one starts from: then R'R differs from A off the diagonal.
TEST(DenseFactor, RaisesOnlyTheDiagonalOfWhatIsNotPositive) {
  constexpr Eigen::Index kSize = 150;
  const Eigen::MatrixXd j = Random(40, kSize, 2);
  Eigen::MatrixXd a = j.transpose() * j;  // of rank 40
  a(130, 130) -= 0.5;                     // and not even semidefinite
  Eigen::MatrixXd factor = a;
  FactorUpper(1e-5, 1e-12, &factor);
  Eigen::MatrixXd raised = Upper(factor).transpose() * Upper(factor) - a;
  const Eigen::VectorXd diagonal = raised.diagonal();
  raised.diagonal().setZero();
  EXPECT_LT(raised.norm(), 1e-10 * a.norm());
  EXPECT_GT(diagonal.minCoeff(), 0);
  EXPECT_GT(diagonal.maxCoeff(), 0.01);
  EXPECT_LT(diagonal.maxCoeff(), 20);
}

// Breaks when the blocks of a task, and with them the order of its sums, depend
// on who does them.
TEST(DenseFactor, DoesNotDependOnTheNumberOfThreads) {
  const Eigen::MatrixXd a = RandomPositive(700, 3);
  const int threads = NumThreads();
  Eigen::MatrixXd one = a, two = a;
  SetNumThreads(1);
  FactorUpper(1e-5, 1e-12, &one);
  SetNumThreads(2);
  FactorUpper(1e-5, 1e-12, &two);
  SetNumThreads(threads);
  EXPECT_EQ(one, two);
}

// Breaks when a function is compiled for the wrong shapes or strides. Rounding
// differs: the numbers have 53 bits, their products are rounded once or twice.
TEST(BlockProduct, EveryInstructionSetSubtractsTheSame) {
  constexpr Eigen::Index kRows = 23, kCols = 31, kDepth = 57, kStride = 64;
  const Eigen::MatrixXd a = Random(kStride, kRows, 4);
  const Eigen::MatrixXd b = Random(kStride, kCols, 5);
  const Eigen::MatrixXd c = Random(kRows + 2, kCols, 6);
  Eigen::MatrixXd expected = c;
  for (Eigen::Index i = 0; i < kRows; ++i) {
    for (Eigen::Index j = 0; j < kCols; ++j) {
      for (Eigen::Index k = 0; k < kDepth; ++k) {
        expected(i, j) -= a(k, i) * b(k, j);
      }
    }
  }
  for (const auto function :
       {BaselineSubtractProduct(), Avx2SubtractProduct(), &SubtractProduct}) {
    if (!function) continue;
    Eigen::MatrixXd result = c;
    function({kRows,
              kCols,
              kDepth,
              a.data(),
              b.data(),
              kStride,
              result.data(),
              result.rows()});
    EXPECT_LT((result - expected).norm(), 1e-13 * expected.norm());
    // Nothing to subtract, as before the first row of a factor.
    Eigen::MatrixXd same = c;
    function({kRows,
              kCols,
              0,
              a.data(),
              b.data(),
              kStride,
              same.data(),
              same.rows()});
    EXPECT_EQ(same, c);
  }
}

}  // namespace
}  // namespace facet
