// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Hessians of the joint solve, E_c part. The cost and its gradient are exact
// and the same for all; the Hessian decides how fast it goes.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "problems/joint_pass.h"

namespace facet {

// Of one plane, over the basis of its increments.
struct JointPlaneBlocks {
  std::vector<int> keyframes;  // that see it or share a term, ascending
  Eigen::Matrix3d plane = Eigen::Matrix3d::Zero();
  Eigen::Matrix<double, 3, Eigen::Dynamic> poses;  // 6 columns a keyframe
};

struct JointHessian {
  Eigen::MatrixXd poses;                 // 6K x 6K, upper triangle
  std::vector<JointPlaneBlocks> planes;  // empty when planes are fixed
};

using PlaneBasis = Eigen::Matrix<double, 4, 3>;

// All blocks, zero, for the keyframes that see a plane.
JointHessian ZeroJointHessian(const TextureProblem& problem, size_t num_planes);

// From the tensors of `pass` (its header has the formula); `common_share` is
// kappa. `plane_basis` has for each plane the increments of (n, d) that the
// three rows and columns stand for, or is empty to keep planes fixed.
JointHessian TensorHessian(const TextureProblem& problem,
                           const JointPass& pass,
                           const std::vector<PlaneBasis>& plane_basis,
                           double weight,
                           double common_share);

// The Gauss-Newton Hessian of sum (I_i - mean)^2, texel by texel:
//   H = sum_p ( sum_i J_i^T J_i - (sum_i J_i)^T (sum_i J_i) / m )
// the Schur complement of the colours. (With a robust loss J_i^T J_i and J_i
// are weighted with rho' and m is the sum of these; with three channels, their
// mean.) About n^2 work a texel seen by n views.
JointHessian ExactHessian(const TextureProblem& problem,
                          const ReconState& state,
                          const std::vector<PlaneBasis>& plane_basis,
                          double weight);

}  // namespace facet
