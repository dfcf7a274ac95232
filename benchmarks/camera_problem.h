// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The camera step of one keyframe (problems/pose_warp_step.h) with E_c in four
// forms that have the same minimum.
#pragma once

#include <ceres/problem.h>
#include <ceres/solver.h>

#include <deque>
#include <vector>

#include "benchmarks/bench_scene.h"
#include "benchmarks/observation_costs.h"
#include "problems/cell_bins.h"

namespace facet {

enum class CostForm {
  kCompressed,  // production: costs/frame_cell_cost.h
  kBatched,     // one cost function a warp cell, one row an observation
  kAnalytic,    // one cost function an observation
  kAutodiff,    // the same by automatic differentiation: costs/photometric.h
};
inline constexpr const char* kCostFormNames[] = {
    "compressed", "batched", "analytic", "autodiff"};

// Works on the pose and the warp of `state` in place. All arguments must
// outlive it. Not movable: the costs point at its members.
class CameraProblem {
 public:
  CameraProblem(const BenchScene& bench,
                const std::vector<PhotoChannel>& channels,
                CostForm form,
                int keyframe,
                ReconState* state);
  CameraProblem(const CameraProblem&) = delete;
  CameraProblem& operator=(const CameraProblem&) = delete;

  ceres::Problem* ceres_problem() { return &ceres_; }
  double* pose() { return pose_; }

 private:
  void AddCell(const BenchScene& bench,
               const std::vector<PhotoChannel>& channels,
               CostForm form,
               int keyframe,
               size_t cell,
               ReconState* state);

  CellBins bins_;
  double *pose_, *warp_;
  std::deque<CellView> views_;  // stable addresses
  ceres::Problem ceres_;
};

// As production solves it, but for exactly `iterations` iterations.
ceres::Solver::Options CameraSolverOptions(int iterations);

}  // namespace facet
