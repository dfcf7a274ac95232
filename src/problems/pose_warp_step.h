// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The camera step of the alternation: E_c + lambda2 E_s + E_prior over the pose
// and the image warp of each keyframe (6 + 640 unknowns), the rest fixed;
// keyframes do not interact.
#pragma once

#include "problems/solve_blocks.h"

namespace facet {

// `blocks` is kPoses, kWarps or both.
void SolvePosesAndWarps(const TextureProblem& problem,
                        const EnergyWeights& weights,
                        unsigned blocks,
                        const SolverConfig& config,
                        SolverMemory* memory,
                        ReconState* state,
                        PhaseSummary* summary);

}  // namespace facet
