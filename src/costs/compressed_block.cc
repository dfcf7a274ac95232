// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "costs/compressed_block.h"

#include <glog/logging.h>

#include <Eigen/Core>
#include <cmath>

namespace facet {

void CompressGram(int n, const double* gram, double* rows, double* residuals) {
  CHECK_LE(n, 32);
  const int stride = n + 1;
  Eigen::Map<
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>
      u(rows, n + 1, n);
  u.setZero();
  double explained = 0;
  for (int i = 0; i < n; ++i) {
    // Row i of U and of U^T r' = J^T r, in one sweep.
    const double diagonal = gram[i * stride + i];
    double pivot = diagonal * (1 + kGramShift);
    double g = gram[i * stride + n];
    for (int k = 0; k < i; ++k) {
      pivot -= u(k, i) * u(k, i);
      g -= u(k, i) * residuals[k];
    }
    if (!(pivot > 0.1 * kGramShift * diagonal) || diagonal <= 0) {
      residuals[i] = 0;
      continue;
    }
    u(i, i) = std::sqrt(pivot);
    const double inverse = 1.0 / u(i, i);
    for (int j = i + 1; j < n; ++j) {
      double sum = gram[i * stride + j];
      for (int k = 0; k < i; ++k) sum -= u(k, i) * u(k, j);
      u(i, j) = sum * inverse;
    }
    residuals[i] = g * inverse;
    explained += residuals[i] * residuals[i];
  }
  const double rest = gram[n * stride + n] - explained;
  residuals[n] = rest > 0 ? std::sqrt(rest) : 0.0;
}

}  // namespace facet
