// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Pose prior: holds the gauge (method, Sec. 7.6). E_c alone does not notice
// when all poses and planes move together; without a prior the model slides
// away.
//
//   E_prior = sum_i | W (T_i T_i0^-1 - identity) |^2
//
// Residual    scale (omega / sigma_r, tau / sigma_t)                 6
//             omega  rotation vector of R_i R_i0^T          [rad]
//             tau    translation of T_i T_i0^-1             [m]
// Parameters  pose cam_from_world (layout of se3_manifold.h)         7
// The scale makes the term commensurable with squared intensities, which are
// not divided by their noise variance (problems/energy.h: InitialPriorScale).
#pragma once

#include <ceres/autodiff_cost_function.h>
#include <ceres/rotation.h>

#include "geometry/pose.h"

namespace facet {

struct PosePriorSigmas {
  double rotation_rad = 0.3 * 3.14159265358979 / 180;
  double translation_m = 0.01;
  double scale = 1;  // [intensity]
};

class PosePriorCost {
 public:
  PosePriorCost(const Pose& initial_cam_from_world,
                const PosePriorSigmas& sigmas)
      : world_from_initial_(initial_cam_from_world.Inverse()),
        rotation_weight_(sigmas.scale / sigmas.rotation_rad),
        translation_weight_(sigmas.scale / sigmas.translation_m) {}

  template <typename T>
  bool operator()(const T* pose, T* residual) const {
    const Eigen::Map<const Eigen::Quaternion<T>> q(pose);
    const Eigen::Map<const Eigen::Matrix<T, 3, 1>> t(pose + 4);
    const Eigen::Quaternion<T> dq = q * world_from_initial_.rotation.cast<T>();
    const Eigen::Matrix<T, 3, 1> tau =
        q * world_from_initial_.translation.cast<T>() + t;
    const T wxyz[4] = {dq.w(), dq.x(), dq.y(), dq.z()};
    T omega[3];
    ceres::QuaternionToAngleAxis(wxyz, omega);
    for (int k = 0; k < 3; ++k) {
      residual[k] = rotation_weight_ * omega[k];
      residual[3 + k] = translation_weight_ * tau[k];
    }
    return true;
  }

  static ceres::CostFunction* Create(const Pose& initial_cam_from_world,
                                     const PosePriorSigmas& sigmas) {
    return new ceres::AutoDiffCostFunction<PosePriorCost, 6, 7>(
        new PosePriorCost(initial_cam_from_world, sigmas));
  }

 private:
  Pose world_from_initial_;
  double rotation_weight_, translation_weight_;
};

}  // namespace facet
