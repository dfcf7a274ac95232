// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The plane step of the alternation: E_c + lambda1 E_p over each plane, the
// rest fixed; planes do not interact.
#pragma once

#include "problems/solve_blocks.h"

namespace facet {

void SolvePlanes(const TextureProblem& problem,
                 const EnergyWeights& weights,
                 const SolverConfig& config,
                 SolverMemory* memory,
                 ReconState* state,
                 PhaseSummary* summary);

}  // namespace facet
