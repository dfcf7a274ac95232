// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// What the joint solve computes at a point, once for all its cost functions:
// the energy, and where Ceres asks for derivatives the system R.
#pragma once

#include <ceres/evaluation_callback.h>

#include <vector>

#include "costs/se3_manifold.h"
#include "problems/following_planes.h"
#include "problems/joint_pass.h"
#include "problems/joint_system.h"
#include "problems/joint_terms.h"
#include "problems/solve_blocks.h"

namespace facet {

// Runs the pass whenever Ceres moves to a new point; its cost functions only
// read the results. The poses of the state are Ceres's parameter memory, its
// planes are placed by `planes`; null: they are fixed.
class JointEvaluation : public ceres::EvaluationCallback {
 public:
  JointEvaluation(const TextureProblem& problem,
                  const EnergyWeights& weights,
                  const SolverConfig& config,
                  const ReconState* state,
                  FollowingPlanes* planes);

  void PrepareForEvaluation(bool evaluate_jacobians,
                            bool new_evaluation_point) override;

  // E_c at the state of the moment, weighted.
  double InitialCost() const;

  // False if the point is none: a plane or a term refuses it.
  bool valid() const { return valid_; }
  // Whether the rows are to be read, or RestResidual alone is the whole cost.
  bool use_system() const { return use_system_; }
  const JointSystem& system() const { return system_; }
  // Three rows of R over the offset of a plane.
  Eigen::Matrix<double, 3, Eigen::Dynamic> PlaneRows(int plane) const {
    return system_.planes[plane].diagonal * planes_->BasisFromOffset(plane);
  }
  const PoseLift& lift(size_t keyframe) const { return lift_[keyframe]; }

  // What the rows leave of the cost, and a constant that keeps it above zero.
  double RestResidual() const;
  double reserve() const { return reserve_; }

 private:
  void RunPass();
  void ComputeSystem();
  void FactorHessian(double weight, double plane_weight);

  const TextureProblem& problem_;
  const EnergyWeights& weights_;
  const SolverConfig& config_;
  double own_share_, common_share_;
  const ReconState* state_;
  FollowingPlanes* planes_;
  JointTerms terms_;
  double cost_ = 0, reserve_ = 0;
  bool has_pass_ = false, has_system_ = false, use_system_ = false;
  bool valid_ = true;
  JointPass pass_;
  JointSystem system_;
  std::vector<PlaneBasis> hessian_basis_;  // of system_
  int num_systems_ = 0;
  std::vector<PoseLift> lift_;
};

}  // namespace facet
