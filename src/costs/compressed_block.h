// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Exact compression of many residuals into a few rows.
//
// N residuals r with Jacobian J over n parameters are, for a least-squares
// solver, the triple (J^T J, J^T r, r^T r). With J^T J = U^T U (Cholesky) the
// n + 1 rows
//
//   Jacobian [U; 0],   residuals [U^-T J^T r;  sqrt(r^T r - |U^-T J^T r|^2)]
//
// have the same triple: cost, gradient and Gauss-Newton Hessian are unchanged
// and Ceres handles n + 1 rows instead of N. This is what lets millions of
// photometric residuals go through Ceres (docs/design.md).
#pragma once

namespace facet {

// Relative diagonal shift of J^T J before factoring. The Gram matrix is summed
// from float lanes and may be indefinite by rounding of some 1e-7; 5e-7 of the
// diagonal keeps the factor meaningful, leaves cost and gradient exact and
// changes the step, also of ill-conditioned poses, by a few 1e-5.
inline constexpr double kGramShift = 5e-7;

// Compresses `gram`, the (n+1) x (n+1) upper triangle (row-major) of
// [J r]^T [J r], into `rows`: (n+1) x n row-major, and `residuals`: n + 1.
// Columns without any gradient become zero rows. n <= 32.
void CompressGram(int n, const double* gram, double* rows, double* residuals);

}  // namespace facet
