// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "problems/joint_evaluation.h"

#include <cmath>
#include <utility>

#include "costs/plane_manifold.h"

namespace facet {

JointEvaluation::JointEvaluation(const TextureProblem& problem,
                                 const EnergyWeights& weights,
                                 const SolverConfig& config,
                                 const ReconState* state,
                                 FollowingPlanes* planes)
    : problem_(problem),
      weights_(weights),
      config_(config),
      own_share_(config.joint_method == JointMethod::kConsensus
                     ? config.joint_own_share
                     : 1.0),
      common_share_(config.joint_method == JointMethod::kFrozen
                        ? 0.0
                        : config.joint_common_share),
      state_(state),
      planes_(planes),
      terms_(problem, weights, planes != nullptr) {}

void JointEvaluation::PrepareForEvaluation(bool evaluate_jacobians,
                                           bool new_evaluation_point) {
  if (new_evaluation_point) has_pass_ = has_system_ = false;
  // With derivatives even if Ceres asks for the cost of a step alone: it
  // accepts most steps, and then asks for them at the same point.
  if (!has_pass_) RunPass();
  if (!valid_) return;
  if (evaluate_jacobians && !has_system_) ComputeSystem();
  use_system_ = evaluate_jacobians;
  // An approximate Hessian may explain more than there is: a constant added
  // to the cost keeps the last row real.
  if (reserve_ == 0) reserve_ = cost_ + 10 * system_.explained;
}

double JointEvaluation::InitialCost() const {
  return weights_.texel_weight *
         RunJointPass(problem_, *state_, false, 0).squares;
}

double JointEvaluation::RestResidual() const {
  const double rest =
      cost_ + reserve_ - (use_system_ ? system_.explained : 0.0);
  return rest > 0 ? std::sqrt(rest) : 0.0;
}

void JointEvaluation::RunPass() {
  valid_ = (!planes_ || planes_->Place()) && terms_.Evaluate(*state_);
  if (!valid_) return;
  pass_ = RunJointPass(problem_, *state_, true, own_share_);
  // weighted E_c, the terms, and with planes lambda1 E_p.
  cost_ = weights_.texel_weight * pass_.squares + terms_.cost();
  for (int j = 0; planes_ && j < problem_.NumPlanes(); ++j) {
    const Eigen::Map<const Eigen::Vector4d> phi(state_->planes.data() +
                                                kPlaneSize * j);
    cost_ += weights_.texel_weight * weights_.lambda1 *
             phi.dot(problem_.moments[j] * phi);
  }
  has_pass_ = true;
}

void JointEvaluation::ComputeSystem() {
  lift_.clear();
  for (int k = 0; k < problem_.NumKeyframes(); ++k) {
    lift_.push_back(LeftPoseLift(state_->poses.data() + kPoseSize * k));
  }
  const double weight = weights_.texel_weight;
  const double plane_weight = weight * weights_.lambda1;
  if (num_systems_++ % config_.joint_hessian_every == 0) {
    FactorHessian(weight, plane_weight);
  }
  JointGradient gradient =
      GradientOf(problem_, pass_, *state_, weight, plane_weight);
  terms_.AddGradient(&gradient);
  SetResiduals(gradient, hessian_basis_, &system_);
  if (planes_) planes_->Follow(system_, hessian_basis_);
  has_system_ = true;
}

void JointEvaluation::FactorHessian(double weight, double plane_weight) {
  hessian_basis_.clear();
  if (planes_) hessian_basis_ = pass_.plane_axes;
  JointHessian hessian =
      config_.joint_method == JointMethod::kExact
          ? ExactHessian(problem_, *state_, hessian_basis_, weight)
          : TensorHessian(
                problem_, pass_, hessian_basis_, weight, common_share_);
  LimitPlaneSteps(problem_,
                  pass_,
                  *state_,
                  hessian_basis_,
                  weight,
                  plane_weight,
                  config_.max_plane_tilt_rad,
                  config_.max_plane_offset_m,
                  &hessian);
  terms_.AddHessian(hessian_basis_, &hessian);
  system_ = FactorJointSystem(
      problem_, std::move(hessian), hessian_basis_, plane_weight);
}

}  // namespace facet
