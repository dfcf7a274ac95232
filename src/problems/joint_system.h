// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The Gauss-Newton system of the joint solve (problems/joint_pass.h) over all
// poses and planes, as the factor that Ceres gets: with H + shift = R^T R the
// rows R and the residual R^-T g have the exact gradient and the chosen Hessian.
//
// Planes do not interact (a texel has one plane), so they come first in the
// ordering and R is block upper triangular: 3 rows a plane over (plane, poses
// that see it), then 6 rows a pose over (pose, later poses).
#pragma once

#include <Eigen/Core>
#include <vector>

#include "problems/joint_pass.h"

namespace facet {

struct JointPlaneRows {
  std::vector<int> keyframes;       // that see the plane, ascending
  Eigen::Matrix3d diagonal;         // over the plane's tangent, upper
  Eigen::Matrix<double, 3, Eigen::Dynamic> poses;  // 6 columns a keyframe
  Eigen::Vector3d residual;
};

struct JointSystem {
  std::vector<JointPlaneRows> planes;  // empty when planes are fixed
  Eigen::MatrixXd poses;               // upper triangular, 6K x 6K
  Eigen::VectorXd pose_residual;       // 6K
  double explained = 0;                // |R^-T g|^2
};

// `plane_basis`: 4 x 3 PlusJacobian of each plane's manifold, or empty to keep
// planes fixed. `weight` multiplies H and g of E_c (texel area weight). With
// planes, lambda1 E_p is part of the system (`plane_weight` times its moments):
// alone, E_c leaves planes without texture undetermined. `common_share` is kappa
// of joint_pass.h.
JointSystem FactorJointSystem(
    const TextureProblem& problem,
    const JointPass& pass,
    const ReconState& state,
    const std::vector<Eigen::Matrix<double, 4, 3>>& plane_basis,
    double weight,
    double plane_weight,
    double common_share);

}  // namespace facet
