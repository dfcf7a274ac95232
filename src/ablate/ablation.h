// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Runs an ablation. Folder (docs/formats.md):
//
//   scans/<scan>/            synthetic scans and their fused meshes
//   states/<scan>/           the stages partition to keyframes, computed once
//   runs/<scan>/<variant>/   run folders, each begun from a copy of the state
//
// Everything has a mark that is written last (scan.json, state.json, run.json)
// and holds what it was made from: what has the right mark is not made again,
// what has none or another one is removed and made anew. So a killed ablation
// goes on where it was.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "ablate/plan.h"
#include "ablate/run_result.h"

namespace facet {

// All runs, by scan, then variant; those that failed carry their problem.
// `print` gets a line for every step. Throws OptionsError if runs have other
// observations (unless the plan allows it), Interrupted (ablate/jobs.h), and
// InputError if the folder cannot be used or is in use.
std::vector<RunResult> RunAblation(
    const AblationPlan& plan,
    const std::function<void(const std::string&)>& print);

// "done" or "to do", by scan, then variant.
std::vector<std::string> RunStates(const AblationPlan& plan);

}  // namespace facet
