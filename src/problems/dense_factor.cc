// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "problems/dense_factor.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "problems/block_product.h"
#include "util/parallel_for.h"

namespace facet {
namespace {

// Rows that are factored together, and columns of a task.
constexpr Eigen::Index kRows = 60, kColumns = 240;

// Copies the triangle above the diagonal to the one below, or back.
void MirrorTriangle(Eigen::MatrixXd* a, bool down) {
  const Eigen::Index n = a->rows();
  ParallelForChunks(0, n, kRows, [&](Eigen::Index begin, Eigen::Index end) {
    for (Eigen::Index k = 0; k < end; k += kRows) {
      for (Eigen::Index j = begin; j < end; ++j) {
        for (Eigen::Index i = k; i < std::min(k + kRows, j); ++i) {
          if (down) {
            (*a)(j, i) = (*a)(i, j);
          } else {
            (*a)(i, j) = (*a)(j, i);
          }
        }
      }
    }
  });
}

// R of R^T R = A in place of A, both by their upper triangles, block row by
// block row; the blocks of a row on all threads. What is below the diagonal
// stays. False if A is not positive.
bool FactorInPlace(Eigen::MatrixXd* a) {
  const Eigen::Index n = a->rows();
  Eigen::MatrixXd corner;
  for (Eigen::Index k = 0; k < n; k += kRows) {
    const Eigen::Index rows = std::min(kRows, n - k);
    const auto subtract = [&](Eigen::Index j,
                              Eigen::Index cols,
                              double* c,
                              Eigen::Index stride) {
      SubtractProduct({rows, cols, k, &(*a)(0, k), &(*a)(0, j), n, c, stride});
    };
    corner = a->block(k, k, rows, rows);
    const size_t num_panels = (n - k - rows + kColumns - 1) / kColumns;
    ParallelFor(0, num_panels + 1, [&](size_t i) {
      if (i == 0) {
        subtract(k, rows, corner.data(), rows);
        return;
      }
      const Eigen::Index j = k + rows + kColumns * (i - 1);
      subtract(j, std::min(kColumns, n - j), &(*a)(k, j), n);
    });
    const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>, Eigen::Upper> llt(corner);
    if (llt.info() != Eigen::Success) return false;
    a->block(k, k, rows, rows).triangularView<Eigen::Upper>() = corner;
    ParallelFor(0, num_panels, [&](size_t i) {
      const Eigen::Index j = k + rows + kColumns * i;
      auto panel = a->block(k, j, rows, std::min(kColumns, n - j));
      corner.transpose().triangularView<Eigen::Lower>().solveInPlace(panel);
    });
  }
  return true;
}

}  // namespace

void FactorUpper(double relative_shift,
                 double absolute_shift,
                 Eigen::MatrixXd* a) {
  const Eigen::VectorXd diagonal = a->diagonal();
  Eigen::VectorXd raised = diagonal;
  MirrorTriangle(a, true);
  for (double shift = relative_shift; !FactorInPlace(a); shift *= 10) {
    MirrorTriangle(a, false);
    raised += shift * diagonal.cwiseAbs();
    raised.array() += absolute_shift;
    a->diagonal() = raised;
  }
}

}  // namespace facet
