// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Terms of the objective over poses and planes: the pose prior, the depth term,
// and those of your own (docs/add-a-residual.md). A term is a list of Ceres
// cost functions, each over one pose, one plane, or one of each; the phases
// Phi, T and T+F, the joint solves and the energy evaluator all take it from
// here.
#pragma once

#include <ceres/cost_function.h>
#include <ceres/problem.h>

#include <memory>
#include <string>
#include <vector>

namespace facet {

struct EnergyWeights;
struct ReconState;
struct TextureProblem;

// Adds |r|^2 to the objective. Parameter blocks: the pose cam_from_world of
// `keyframe` (7, costs/se3_manifold.h), then `plane` (4: n, d about its
// anchor); -1 = has no such parameter. Evaluated on many threads at once.
struct TermBlock {
  std::shared_ptr<const ceres::CostFunction> cost;
  int keyframe = -1, plane = -1;
};

struct Term {
  std::string name;
  std::vector<TermBlock> blocks;
};

// The pose prior (none without EnergyWeights::pose_prior) and the depth term
// (none with weight 0), weighted.
Term PosePriorTerm(const TextureProblem& problem, const EnergyWeights& weights);
Term DepthTerm(const TextureProblem& problem, const EnergyWeights& weights);

// Sum of |r|^2.
double EvaluateTerm(const Term& term, const ReconState& state);

// All terms of a problem, ready to be added to Ceres problems whose parameters
// live in a state.
class TermBlocks {
 public:
  TermBlocks(const TextureProblem& problem, const EnergyWeights& weights);

  const std::vector<TermBlock>& blocks() const { return blocks_; }

  // The blocks of one pose or plane, their other parameter constant.
  void AddPose(int keyframe, ReconState* state, ceres::Problem* problem) const;
  void AddPlane(int plane, ReconState* state, ceres::Problem* problem) const;
  // All blocks of its parameters; planes that the problem does not have yet
  // are constant.
  void AddAll(ReconState* state, ceres::Problem* problem) const;

 private:
  void Add(const TermBlock& block,
           ReconState* state,
           ceres::Problem* problem) const;
  // The blocks of these indices; all their parameters but `moving` constant.
  void AddAround(const double* moving,
                 const std::vector<size_t>& indices,
                 ReconState* state,
                 ceres::Problem* problem) const;

  std::vector<TermBlock> blocks_;
  std::vector<std::vector<size_t>> of_pose_, of_plane_;  // indices of blocks
};

}  // namespace facet
