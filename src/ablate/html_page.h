// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// index.html of an ablation: one file that needs no other one.
#pragma once

#include <string>
#include <vector>

#include "ablate/plan.h"
#include "ablate/plots.h"
#include "ablate/run_result.h"

namespace facet {

// Tables, plots, and previews side by side of the first scan of each group
// whose runs drew them (RUN/previews/after_<view>.png, made smaller).
std::string HtmlPage(const AblationPlan& plan,
                     const std::vector<RunResult>& runs,
                     const std::vector<NamedPlot>& plots);

// RFC 4648, with padding.
std::string Base64(const std::vector<unsigned char>& bytes);

}  // namespace facet
