// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// What the joint solve computes at a point, once for all its cost functions:
// the energy, and where Ceres asks for derivatives the system R.
#pragma once

#include <ceres/evaluation_callback.h>

#include <vector>

#include "problems/joint_coordinates.h"
#include "problems/joint_pass.h"
#include "problems/joint_system.h"
#include "problems/joint_terms.h"
#include "problems/solve_blocks.h"

namespace facet {

// Moves the state and runs the pass whenever Ceres moves to a new point; its
// cost functions only read the results. Ceres's parameters are the offsets of
// `coordinates`.
class JointEvaluation : public ceres::EvaluationCallback {
 public:
  JointEvaluation(const TextureProblem& problem,
                  const EnergyWeights& weights,
                  const SolverConfig& config,
                  const ReconState* state,
                  JointCoordinates* coordinates);

  void PrepareForEvaluation(bool evaluate_jacobians,
                            bool new_evaluation_point) override;

  // False if the point is none: a plane or a term refuses it.
  bool valid() const { return valid_; }
  // Whether the rows are to be read, or RestResidual alone is the whole cost.
  bool use_system() const { return use_system_; }
  const JointSystem& system() const { return system_; }
  const JointCoordinates& coordinates() const { return *coordinates_; }
  // Six rows of R over the offsets of a pose and of all later ones: one 6 x 6
  // cell after the other, row-major, in one piece as Ceres copies them.
  const double* PoseRows(int keyframe) const {
    return pose_rows_.data() + CellIndex(keyframe) * kCell;
  }
  static constexpr ptrdiff_t kCell = 36;

  // What the rows leave of the cost, and a constant that keeps it above zero.
  double RestResidual() const;
  double reserve() const { return reserve_; }

 private:
  void RunPass();
  void ComputeSystem();
  void FillPoseRows();
  // Cells before those of a keyframe.
  ptrdiff_t CellIndex(int keyframe) const {
    const ptrdiff_t k = keyframe;
    return k * problem_.NumKeyframes() - k * (k - 1) / 2;
  }
  void FactorHessian(double weight, double plane_weight);

  const TextureProblem& problem_;
  const EnergyWeights& weights_;
  const SolverConfig& config_;
  double own_share_, common_share_;
  const ReconState* state_;
  JointCoordinates* coordinates_;
  JointTerms terms_;
  double cost_ = 0, reserve_ = 0;
  bool has_pass_ = false, has_system_ = false, use_system_ = false;
  bool valid_ = true;
  JointPass pass_;
  JointSystem system_;
  std::vector<PlaneBasis> hessian_basis_;  // of system_
  std::vector<double> pose_rows_;
  int num_passes_ = 0, num_systems_ = 0;
};

}  // namespace facet
