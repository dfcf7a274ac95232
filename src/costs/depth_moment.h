// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// E_d: depth-to-plane term (method, Sec. 10.3 iii), of all depth samples of one
// keyframe on one plane. E_c hardly tells a turn of the camera from a shift
// along a wall; the measured distances do.
//
//   E_d(T, phi) = sum_x w_x (n.(T^-1 x) + w)^2 = psi^T M psi
//   psi = (R n, w - (R n).t)      the plane in camera coordinates
//   M = sum_x w_x m m^T,  m = (x, 1)                         4 x 4
//
// Residual    sqrt(weight) L^T psi with M = L L^T            4 rows
//             w_x = 1 / variance of the distance             [1/m^2]
// Parameters  pose cam_from_world (se3_manifold.h)           7
//             plane (n, d) about its anchor c, w = d - n.c   4
// Exact: M is a constant, no sample is visited again.
#pragma once

#include <ceres/autodiff_cost_function.h>

#include <Eigen/Geometry>

#include "costs/moment_factor.h"

namespace facet {

class DepthMomentCost {
 public:
  DepthMomentCost(const Eigen::Matrix4d& moment,
                  const Eigen::Vector3d& anchor,
                  double weight)
      : factor_(MomentFactor(moment, weight)), anchor_(anchor) {}

  template <typename T>
  bool operator()(const T* pose, const T* plane, T* residual) const {
    using Vector3 = Eigen::Matrix<T, 3, 1>;
    const Eigen::Map<const Eigen::Quaternion<T>> q(pose);
    const Eigen::Map<const Vector3> t(pose + 4);
    const Vector3 n(plane[0], plane[1], plane[2]);
    const Vector3 m = q * n;
    Eigen::Matrix<T, 4, 1> psi;
    psi << m, plane[3] - n.dot(anchor_.cast<T>()) - m.dot(t);
    Eigen::Map<Eigen::Matrix<T, 4, 1>> r(residual);
    r = factor_.cast<T>() * psi;
    return true;
  }

  static ceres::CostFunction* Create(const Eigen::Matrix4d& moment,
                                     const Eigen::Vector3d& anchor,
                                     double weight) {
    return new ceres::AutoDiffCostFunction<DepthMomentCost, 4, 7, 4>(
        new DepthMomentCost(moment, anchor, weight));
  }

 private:
  Eigen::Matrix4d factor_;
  Eigen::Vector3d anchor_;
};

}  // namespace facet
