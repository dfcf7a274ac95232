// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// E_p: plane constraint term (paper, Sec. 3.3), of all texels of one plane.
//
//   E_p(phi) = sum_p (n.(p - c) + d)^2 = phi^T M phi,  phi = (n, d)
//   M = sum_p m m^T,  m = (p - c, 1)                         4 x 4, [m^2, m, 1]
//
// Residual    L^T phi with M = L L^T                          4 rows [m]
// Parameters  plane (n_x, n_y, n_z, d)                        4
// Weight      lambda1, applied in problems/; not here.
// Exact: M is a constant, no texel is visited again.
#pragma once

#include <ceres/sized_cost_function.h>

#include <Eigen/Core>

#include "costs/moment_factor.h"

namespace facet {

class PlaneMomentCost : public ceres::SizedCostFunction<4, 4> {
 public:
  // `weight` multiplies the squared residuals.
  PlaneMomentCost(const Eigen::Matrix4d& moment, double weight)
      : factor_(MomentFactor(moment, weight)) {}

  bool Evaluate(double const* const* parameters,
                double* residuals,
                double** jacobians) const override {
    const Eigen::Map<const Eigen::Vector4d> phi(parameters[0]);
    Eigen::Map<Eigen::Vector4d> r(residuals);
    r = factor_ * phi;
    if (jacobians && jacobians[0]) {
      Eigen::Map<Eigen::Matrix<double, 4, 4, Eigen::RowMajor>> j(jacobians[0]);
      j = factor_;
    }
    return true;
  }

 private:
  Eigen::Matrix4d factor_;
};

}  // namespace facet
