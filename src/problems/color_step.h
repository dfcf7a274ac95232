// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The colour step of the alternation (paper, Sec. 3.3): with poses, planes and
// warps fixed, the C that minimises E_c is the mean of the observed
// intensities, in closed form; with a robust loss the weighted mean that
// reproduces its own weights (iteratively reweighted least squares).
#pragma once

#include "problems/texture_problem.h"

namespace facet {

// Sets state->colors, channel by channel; texels without observations keep
// their colour.
void SolveColors(const TextureProblem& problem, ReconState* state);

}  // namespace facet
