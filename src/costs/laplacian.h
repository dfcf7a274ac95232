// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// E_t, smoothness of the geometry (paper, Sec. 3.4).
//
//   E_t(V) = sum_i | v_i - 1/|N(i)| sum_{j in N(i)} v_j |^2
//
// Residual    sqrt(lambda3) (L X)_i                     [m]   3
// Parameters  v_i, then v_j for j in N(i)               [m]   3 each
// Weight      lambda3 of the energy
// See also    mesh/laplacian.h, problems/geometry_problem.h
#pragma once

#include <ceres/dynamic_autodiff_cost_function.h>

#include <cmath>

namespace facet {

struct LaplacianCost {
  // `degree` = |N(i)| >= 1.
  static ceres::CostFunction* Create(int degree, double lambda3) {
    auto* cost = new ceres::DynamicAutoDiffCostFunction<LaplacianCost, 4>(
        new LaplacianCost{degree, std::sqrt(lambda3)});
    for (int k = 0; k <= degree; ++k) cost->AddParameterBlock(3);
    cost->SetNumResiduals(3);
    return cost;
  }

  template <typename T>
  bool operator()(const T* const* vertices, T* residual) const {
    for (int axis = 0; axis < 3; ++axis) {
      T sum(0.0);
      for (int k = 1; k <= degree; ++k) sum += vertices[k][axis];
      residual[axis] =
          sqrt_weight * (vertices[0][axis] - sum / static_cast<double>(degree));
    }
    return true;
  }

  int degree;
  double sqrt_weight;
};

}  // namespace facet
