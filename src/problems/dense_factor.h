// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Cholesky factor of a dense symmetric matrix in its own memory, on all
// threads.
#pragma once

#include <Eigen/Core>

namespace facet {

// Puts R of R' R = A into the upper triangle of A, which gives A; what is below
// the diagonal is not read, and is A's upper triangle afterwards. Where A is
// not positive its diagonal d is raised by relative_shift |d| + absolute_shift,
// then by ten times the first, and so on until it is; both must be above zero,
// and A finite. The result does not depend on the number of threads.
void FactorUpper(double relative_shift,
                 double absolute_shift,
                 Eigen::MatrixXd* a);

}  // namespace facet
