// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The plots of an ablation, one line a variant.
#pragma once

#include <string>
#include <vector>

#include "ablate/plan.h"
#include "ablate/run_result.h"
#include "ablate/svg_plot.h"

namespace facet {

struct NamedPlot {
  std::string file;  // without folder and extension, unique
  std::string group;
  Plot plot;
};

// For every group of scans, against CPU time and against iterations: E_tex and
// E_c as shares of their start, and what is left of E(0) - E_best; with ground
// truth the errors of poses and planes. Lines are means over the scans of
// the group: between phases interpolated, after the last one held. Runs with
// another energy than the first variant's have no energy line.
std::vector<NamedPlot> MakePlots(const AblationPlan& plan,
                                 const std::vector<RunResult>& runs);

// The mean of piecewise linear curves on the union of their x; each keeps its
// last value. Curves are given by points with ascending x.
struct Curve {
  std::vector<double> x, y;
};
Curve MeanCurve(const std::vector<Curve>& curves);

}  // namespace facet
