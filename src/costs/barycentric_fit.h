// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// E_g, the mesh follows the projected texels (paper, Eq. geo; method,
// Sec. 8.2).
//
//   E_g(V) = sum_p | q_p - sum_k b_{p,k} v_k |^2
//
// q is affine in p inside a face, so all texels of a face collapse into their
// 3x3 moment M = sum_p b b' and the targets T of its corners:
//
//   E_g = sum_faces tr[ (V_f - T_f)' M_f (V_f - T_f) ]
//
// Residual    R (V_f - T_f), column by column, R' R = M    [m]   9
// Parameters  v_0, v_1, v_2                                [m]   3 each
// Constants   root R (3x3), targets T_f, rows = corners    [m]
// Weight      1
// See also    problems/geometry_problem.h
#pragma once

#include <ceres/autodiff_cost_function.h>

#include <Eigen/Core>

namespace facet {

struct BarycentricFitCost {
  static ceres::CostFunction* Create(const Eigen::Matrix3d& root,
                                     const Eigen::Matrix3d& targets) {
    return new ceres::AutoDiffCostFunction<BarycentricFitCost, 9, 3, 3, 3>(
        new BarycentricFitCost{root, targets});
  }

  template <typename T>
  bool operator()(const T* v0, const T* v1, const T* v2, T* residual) const {
    for (int axis = 0; axis < 3; ++axis) {
      const T gap0 = v0[axis] - targets(0, axis);
      const T gap1 = v1[axis] - targets(1, axis);
      const T gap2 = v2[axis] - targets(2, axis);
      for (int row = 0; row < 3; ++row) {
        residual[3 * axis + row] =
            root(row, 0) * gap0 + root(row, 1) * gap1 + root(row, 2) * gap2;
      }
    }
    return true;
  }

  Eigen::Matrix3d root, targets;
};

}  // namespace facet
