// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Which runs may be compared, and the figures that need several of them.
#pragma once

#include <vector>

#include "ablate/plan.h"
#include "ablate/run_result.h"

namespace facet {

// Throws OptionsError if `run` has other texels or observations than a finished
// run of the same scan among `others`.
void CheckSameObservations(const AblationPlan& plan,
                           const RunResult& run,
                           const std::vector<RunResult>& others);

// Whether both minimise the same function: the same observations, E_tex of the
// common start and lambdas (1e-6 relative). It differs e.g. with --smoothing.
bool SameEnergy(const RunResult& a, const RunResult& b);

// Fills same_observations and same_energy of all finished runs, and
// cpu_s_to_99: the CPU time of the first phase after which E_tex is at most
// E(0) - 0.99 (E(0) - E_best), where E_best is the lowest E_tex in the trace of
// any run of the same scan with the same energy. Runs with the energy of the
// reference, the first variant on their scan, also get
//   cpu_s_to_reference: the CPU time of the first phase after which E_tex is at
//     most the one the reference ended with (NaN: never), and
//   speedup_to_reference: that time of the reference, divided by it.
void CompareRuns(std::vector<RunResult>* runs);

// The lowest E_tex in the traces of all runs that share the energy of `run`.
double BestEnergy(const RunResult& run, const std::vector<RunResult>& runs);

}  // namespace facet
