// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The terms of problems/term.h and the common motion of problems/gauge.h as
// part of the joint system: sum |r|^2, its gradient and its Gauss-Newton
// Hessian J^T J.
#pragma once

#include <ceres/cost_function.h>

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "problems/joint_hessian.h"
#include "problems/joint_system.h"
#include "problems/term.h"

namespace facet {

class JointTerms {
 public:
  // Planes that do not move, those that no keyframe sees or all without
  // `with_planes`, are constants of their blocks; blocks of nothing else are
  // left out.
  JointTerms(const TextureProblem& problem,
             const EnergyWeights& weights,
             bool with_planes);

  // Adds the mean motion of all poses, so stiff that 1 mm costs `e_c`.
  void HoldCommonMotion(const TextureProblem& problem, double e_c);

  // Residuals and Jacobians at `state`. False if a cost function refuses it;
  // what the functions below give is then of no use.
  bool Evaluate(const ReconState& state);

  double cost() const;  // sum |r|^2
  void AddGradient(JointGradient* gradient) const;
  // `plane_basis` as for the Hessian: empty when planes are fixed.
  void AddHessian(const std::vector<PlaneBasis>& plane_basis,
                  JointHessian* hessian) const;

 private:
  struct Block {
    TermBlock term;
    bool plane_moves;
    Eigen::VectorXd residual;
    Eigen::Matrix<double, Eigen::Dynamic, 6> by_pose;   // left tangent
    Eigen::Matrix<double, Eigen::Dynamic, 4> by_plane;  // ambient (n, d)
  };
  bool EvaluateMotion(const ReconState& state);

  std::vector<Block> blocks_;
  // Over all poses; may be null.
  std::unique_ptr<const ceres::CostFunction> motion_;
  Vector6d motion_residual_ = Vector6d::Zero();
  Eigen::Matrix<double, 6, Eigen::Dynamic> motion_by_pose_;
};

}  // namespace facet
