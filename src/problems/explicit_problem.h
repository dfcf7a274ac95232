// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The energy as one plain Ceres problem: a residual block an observation
// (costs/photometric.h), colours as parameters, no compression, all in double.
// The readable reference, the oracle of the optimiser's tests, and two ways to
// solve any set of blocks at once on small problems: about 1 kB an observation.
//
//   2 * cost = E_tex + E_prior + E_depth + further terms
#pragma once

#include <ceres/problem.h>
#include <ceres/solver.h>

#include <vector>

#include "problems/energy.h"
#include "problems/solve_blocks.h"

namespace facet {

class ExplicitProblem {
 public:
  // Works on `state` in place; colours on a copy in double (StoreColors).
  ExplicitProblem(const TextureProblem& problem,
                  const EnergyWeights& weights,
                  ReconState* state);

  double Cost();

  // Minimises over the blocks of the BlockSet `free`, the others stay constant.
  ceres::Solver::Summary Solve(unsigned free, ceres::Solver::Options options);

  // One or more Levenberg-Marquardt iterations from the radius 1e4.
  void Step(unsigned free, ceres::LinearSolverType solver, int iterations = 1);

  // Colours in group 0 (they do not share residuals, so that SPARSE_SCHUR can
  // eliminate them), the others in group 1 if at all.
  ceres::ParameterBlockOrdering* Ordering(bool with_others) const;

  ceres::Problem* ceres_problem() { return &ceres_; }
  const std::vector<double>& colors() const { return colors_; }
  void StoreColors() const;

 private:
  double* PlaneBlock(int j);
  double* PoseBlock(int k);
  unsigned Kind(const double* block) const;
  void AddObservations(int k, int channel, double weight);
  void AddKeyframe(int k, const EnergyWeights& weights);
  void AddPlanes(const EnergyWeights& weights);

  const TextureProblem& problem_;
  ReconState* state_;
  std::vector<double> colors_;
  ceres::Problem ceres_;
};

// The methods kSchur and kInner of SolveBlocks; `blocks` contains the colours.
// CheckObservationLimit (problems/formulation.h) keeps them to small problems.
void SolveExplicit(const TextureProblem& problem,
                   const EnergyWeights& weights,
                   unsigned blocks,
                   const SolverConfig& config,
                   SolverMemory* memory,
                   ReconState* state,
                   PhaseSummary* summary);

}  // namespace facet
