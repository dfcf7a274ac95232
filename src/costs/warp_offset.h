// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// E_s: regularisation of the image warp (paper, Eq. main).
//
//   E_s = sum_i sum_l f_il . f_il
//
// Residual    r = f                                           2 [px]
// Parameters  one control vertex f = (f_x, f_y)               2 [px]
// Weight      lambda2, applied in problems/; not here.
#pragma once

#include <ceres/autodiff_cost_function.h>

namespace facet {

struct WarpOffsetCost {
  template <typename T>
  bool operator()(const T* f, T* residual) const {
    residual[0] = f[0];
    residual[1] = f[1];
    return true;
  }

  static ceres::CostFunction* Create() {
    return new ceres::AutoDiffCostFunction<WarpOffsetCost, 2, 2>(
        new WarpOffsetCost);
  }
};

}  // namespace facet
