// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The terms of problems/term.h as part of the joint system: sum |r|^2, its
// gradient and its Gauss-Newton Hessian J^T J.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "problems/joint_hessian.h"
#include "problems/joint_system.h"
#include "problems/term.h"

namespace facet {

class JointTerms {
 public:
  // Without planes, blocks of planes alone are left out.
  JointTerms(const TextureProblem& problem,
             const EnergyWeights& weights,
             bool with_planes);

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
    Eigen::VectorXd residual;
    Eigen::Matrix<double, Eigen::Dynamic, 6> by_pose;   // left tangent
    Eigen::Matrix<double, Eigen::Dynamic, 4> by_plane;  // ambient (n, d)
  };
  std::vector<Block> blocks_;
};

}  // namespace facet
