// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "problems/term.h"

#include <utility>

#include "costs/depth_moment.h"
#include "costs/plane_manifold.h"
#include "costs/pose_prior.h"
#include "costs/se3_manifold.h"
#include "problems/energy.h"
#include "problems/texture_problem.h"

namespace facet {
namespace {

// A cost function that several Ceres problems share: these own the wrapper.
class SharedCost : public ceres::CostFunction {
 public:
  explicit SharedCost(std::shared_ptr<const ceres::CostFunction> cost)
      : cost_(std::move(cost)) {
    set_num_residuals(cost_->num_residuals());
    *mutable_parameter_block_sizes() = cost_->parameter_block_sizes();
  }

  bool Evaluate(double const* const* parameters,
                double* residuals,
                double** jacobians) const override {
    return cost_->Evaluate(parameters, residuals, jacobians);
  }

 private:
  std::shared_ptr<const ceres::CostFunction> cost_;
};

// Where the parameters of a block live; `State` may be const.
template <typename State>
auto ParametersOf(const TermBlock& block, State* state) {
  std::vector<decltype(state->poses.data())> parameters;
  if (block.keyframe >= 0) {
    parameters.push_back(state->poses.data() + kPoseSize * block.keyframe);
  }
  if (block.plane >= 0) {
    parameters.push_back(state->planes.data() + kPlaneSize * block.plane);
  }
  return parameters;
}

}  // namespace

Term PosePriorTerm(const TextureProblem& problem,
                   const EnergyWeights& weights) {
  Term term = {"pose prior", {}};
  for (int k = 0; weights.pose_prior && k < problem.NumKeyframes(); ++k) {
    term.blocks.push_back(
        {std::shared_ptr<const ceres::CostFunction>(PosePriorCost::Create(
             problem.initial_cam_from_world[k], weights.prior)),
         k,
         -1});
  }
  return term;
}

Term DepthTerm(const TextureProblem& problem, const EnergyWeights& weights) {
  Term term = {"depth", {}};
  if (weights.depth_weight == 0) return term;
  for (const DepthMoment& d : problem.depth_moments) {
    term.blocks.push_back(
        {std::shared_ptr<const ceres::CostFunction>(DepthMomentCost::Create(
             d.moment, problem.anchors[d.plane], weights.DepthFactor())),
         d.keyframe,
         d.plane});
  }
  return term;
}

double EvaluateTerm(const Term& term, const ReconState& state) {
  double sum = 0;
  std::vector<double> residuals;
  for (const TermBlock& block : term.blocks) {
    residuals.resize(block.cost->num_residuals());
    block.cost->Evaluate(
        ParametersOf(block, &state).data(), residuals.data(), nullptr);
    for (const double r : residuals) sum += r * r;
  }
  return sum;
}

TermBlocks::TermBlocks(const TextureProblem& problem,
                       const EnergyWeights& weights)
    : of_pose_(problem.NumKeyframes()), of_plane_(problem.NumPlanes()) {
  const auto append = [&](const Term& term) {
    for (const TermBlock& block : term.blocks) {
      if (block.keyframe >= 0) {
        of_pose_[block.keyframe].push_back(blocks_.size());
      }
      if (block.plane >= 0) of_plane_[block.plane].push_back(blocks_.size());
      blocks_.push_back(block);
    }
  };
  append(PosePriorTerm(problem, weights));
  append(DepthTerm(problem, weights));
  for (const Term& term : problem.terms) append(term);
}

void TermBlocks::AddPose(int keyframe,
                         ReconState* state,
                         ceres::Problem* problem) const {
  AddAround(state->poses.data() + kPoseSize * keyframe,
            of_pose_[keyframe],
            state,
            problem);
}

void TermBlocks::AddPlane(int plane,
                          ReconState* state,
                          ceres::Problem* problem) const {
  AddAround(state->planes.data() + kPlaneSize * plane,
            of_plane_[plane],
            state,
            problem);
}

void TermBlocks::AddAround(const double* moving,
                           const std::vector<size_t>& indices,
                           ReconState* state,
                           ceres::Problem* problem) const {
  for (const size_t i : indices) {
    Add(blocks_[i], state, problem);
    for (double* parameter : ParametersOf(blocks_[i], state)) {
      if (parameter != moving) problem->SetParameterBlockConstant(parameter);
    }
  }
}

void TermBlocks::AddAll(ReconState* state, ceres::Problem* problem) const {
  for (const TermBlock& block : blocks_) {
    double* last = ParametersOf(block, state).back();
    const bool constant = block.plane >= 0 && !problem->HasParameterBlock(last);
    if (constant && block.keyframe < 0) continue;
    Add(block, state, problem);
    if (constant) problem->SetParameterBlockConstant(last);
  }
}

void TermBlocks::Add(const TermBlock& block,
                     ReconState* state,
                     ceres::Problem* problem) const {
  problem->AddResidualBlock(
      new SharedCost(block.cost), nullptr, ParametersOf(block, state));
}

}  // namespace facet
