// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// When a plane or keyframe rests (SolverConfig::active_tolerance): the last
// solve of its separate problem hardly gained anything, and its cost is still
// about the same. Colours, planes and poses that it depends on move the cost,
// so that is what wakes it: many small changes add up, as the cost is compared
// with that after the last solve and not with that of the last phase.
#pragma once

#include <ceres/solver.h>

namespace facet {

// In place of a cost to rest at: solve in the next phase.
constexpr double kAwake = -1;

// A change of the cost by this many tolerances wakes. What comes from outside
// is mostly noise that a problem cannot follow, hence more than its own gain.
constexpr double kWakeFactor = 10;

// Whether a problem with the memory `rest` and now the cost `cost` rests.
bool Rests(double rest, double cost, double tolerance);

// What a solve from `cost_before` to `cost` leaves for Rests. `cost` is that of
// the state that is kept: cost_before where the result was undone.
double RestAfter(const ceres::Solver::Summary& solved,
                 double cost_before,
                 double cost,
                 double tolerance);

}  // namespace facet
