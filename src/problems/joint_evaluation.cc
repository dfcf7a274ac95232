// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "problems/joint_evaluation.h"

#include <cmath>
#include <utility>

#include "costs/plane_manifold.h"
#include "util/parallel_for.h"

namespace facet {

JointEvaluation::JointEvaluation(const TextureProblem& problem,
                                 const EnergyWeights& weights,
                                 const SolverConfig& config,
                                 const ReconState* state,
                                 JointCoordinates* coordinates)
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
      coordinates_(coordinates),
      terms_(problem, weights, coordinates->with_planes()) {}

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

double JointEvaluation::RestResidual() const {
  const double rest =
      cost_ + reserve_ - (use_system_ ? system_.explained : 0.0);
  return rest > 0 ? std::sqrt(rest) : 0.0;
}

void JointEvaluation::RunPass() {
  valid_ = coordinates_->Place();
  if (!valid_) return;
  pass_ = RunJointPass(problem_, *state_, true, own_share_);
  if (config_.remove_common_motion && num_passes_++ == 0) {
    terms_.HoldCommonMotion(problem_, weights_.texel_weight * pass_.squares);
  }
  valid_ = terms_.Evaluate(*state_);
  // weighted E_c, the terms, and with planes lambda1 E_p.
  cost_ = weights_.texel_weight * pass_.squares + terms_.cost();
  for (int j = 0; coordinates_->with_planes() && j < problem_.NumPlanes();
       ++j) {
    const Eigen::Map<const Eigen::Vector4d> phi(state_->planes.data() +
                                                kPlaneSize * j);
    cost_ += weights_.texel_weight * weights_.lambda1 *
             phi.dot(problem_.moments[j] * phi);
  }
  valid_ = valid_ && std::isfinite(cost_);
  has_pass_ = valid_;
}

void JointEvaluation::ComputeSystem() {
  const double weight = weights_.texel_weight;
  const double plane_weight = weight * weights_.lambda1;
  if (num_systems_++ % config_.joint_hessian_every == 0) {
    FactorHessian(weight, plane_weight);
  }
  JointGradient gradient =
      GradientOf(problem_, pass_, *state_, weight, plane_weight);
  terms_.AddGradient(&gradient);
  SetResiduals(gradient, hessian_basis_, &system_);
  coordinates_->Linearise(system_, hessian_basis_);
  FillPoseRows();
  has_system_ = true;
}

void JointEvaluation::FillPoseRows() {
  const int num_keyframes = problem_.NumKeyframes();
  pose_rows_.resize(CellIndex(num_keyframes) * kCell);
  ParallelFor(0, num_keyframes, [&](size_t row) {
    const int k = static_cast<int>(row);
    double* cell = pose_rows_.data() + CellIndex(k) * kCell;
    for (int other = k; other < num_keyframes; ++other, cell += kCell) {
      Eigen::Matrix<double, 6, 6> r =
          system_.poses.block<6, 6>(6 * k, 6 * other);
      if (other == k) r = r.triangularView<Eigen::Upper>();
      Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>> j(cell);
      j.noalias() = r * coordinates_->LeftFromPose(other);
    }
  });
}

void JointEvaluation::FactorHessian(double weight, double plane_weight) {
  system_ = JointSystem();  // not the memory of two factors
  hessian_basis_.clear();
  if (coordinates_->with_planes()) hessian_basis_ = pass_.plane_axes;
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
