// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The Gauss-Newton system of the joint solve (problems/joint_pass.h) over all
// poses and planes, as a factor: with H + shift = R^T R the rows R and the
// residual R^-T g have the exact gradient and the chosen Hessian.
//
// Planes do not interact (a texel has one plane), so they come first in the
// ordering and R is block upper triangular: 3 rows a plane over (plane, poses
// that see it), then 6 rows a pose over (pose, later poses). In the coordinates
// of problems/joint_coordinates.h, which Ceres gets, planes are by themselves.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "problems/joint_hessian.h"

namespace facet {

struct JointPlaneRows {
  std::vector<int> keyframes;  // that see it or share a term, ascending
  Eigen::Matrix3d diagonal;    // over the plane's tangent, upper
  Eigen::Matrix<double, 3, Eigen::Dynamic> poses;  // 6 columns a keyframe
  Eigen::Vector3d residual;
};

struct JointSystem {
  std::vector<JointPlaneRows> planes;  // empty when planes are fixed
  // 6K x 6K; R is its upper triangle, below the diagonal is no part of it.
  Eigen::MatrixXd poses;
  Eigen::VectorXd pose_residual;  // 6K
  double explained = 0;           // |R^-T g|^2
};

// Stiffens the plane blocks so that no Gauss-Newton step of a plane by itself
// goes beyond the limits. The energy hardly knows the tilt of planes with a few
// texels or of narrow strips: their steps would turn them over, and the one
// trust region of the joint solve would shrink for all. With r^2 the cost of
// the plane and L the limit,
//
//   mu = r^2 / (2 L)^2   gives   |step| <= |J| |r| / (J^2 + mu) <= L,
//
// and a well determined plane hardly notices. The gradient stays exact.
void LimitPlaneSteps(const TextureProblem& problem,
                     const JointPass& pass,
                     const ReconState& state,
                     const std::vector<PlaneBasis>& plane_basis,
                     double weight,
                     double plane_weight,
                     double max_tilt_rad,
                     double max_offset_m,
                     JointHessian* hessian);

// The rows R of a Hessian, whose factor they are. With planes, lambda1 E_p is
// part of the system (`plane_weight` times its moments): alone, E_c leaves
// planes without texture undetermined. `plane_basis` as for the Hessian.
// Residuals are not set.
JointSystem FactorJointSystem(const TextureProblem& problem,
                              JointHessian hessian,
                              const std::vector<PlaneBasis>& plane_basis,
                              double plane_weight);

// Half the gradient of the objective, or of a part of it.
struct JointGradient {
  std::vector<Vector6d> poses;          // by keyframe, left tangent
  std::vector<Eigen::Vector4d> planes;  // by plane, ambient (n, d)
};

// That of `weight` (texel area weight) times the cost of `pass`, and of
// `plane_weight` = lambda1 times E_p.
JointGradient GradientOf(const TextureProblem& problem,
                         const JointPass& pass,
                         const ReconState& state,
                         double weight,
                         double plane_weight);

// Sets the residuals R^-T g: the system then has this gradient, whatever point
// its Hessian is from. `plane_basis` is that of the Hessian.
void SetResiduals(const JointGradient& gradient,
                  const std::vector<PlaneBasis>& plane_basis,
                  JointSystem* system);

}  // namespace facet
