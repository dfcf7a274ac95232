// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// A quadratic form as residuals: weight x^T M x = |L^T x|^2 with weight M = L
// L^T.
#pragma once

#include <Eigen/Core>
#include <Eigen/Eigenvalues>

namespace facet {

// L^T. M is symmetric and positive semidefinite, but for rounding: a Cholesky
// factor would not exist for flat clusters.
inline Eigen::Matrix4d MomentFactor(const Eigen::Matrix4d& moment,
                                    double weight) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d> eigen(moment);
  return (weight * eigen.eigenvalues().cwiseMax(0.0)).cwiseSqrt().asDiagonal() *
         eigen.eigenvectors().transpose();
}

}  // namespace facet
