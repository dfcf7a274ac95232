// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The joint step: poses, planes and colours at once, warps fixed. facet's own
// contribution beside the paper's alternation (docs/design.md).
//
// One Ceres problem over offsets of all poses and planes
// (problems/joint_coordinates.h). Its rows come from one pass over the
// observations an evaluation (problems/joint_evaluation.h, joint_pass.h,
// joint_system.h): exact cost and gradient with re-averaged colours,
// consensus-tensor Hessian; lambda1 E_p, all terms and the gauge are part of
// it.
#pragma once

#include "problems/solve_blocks.h"

namespace facet {

// `blocks` contains kColors and kPoses, perhaps kPlanes.
void SolveJoint(const TextureProblem& problem,
                const EnergyWeights& weights,
                unsigned blocks,
                const SolverConfig& config,
                SolverMemory* memory,
                ReconState* state,
                PhaseSummary* summary);

}  // namespace facet
