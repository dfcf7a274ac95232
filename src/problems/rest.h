// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// When a plane or keyframe rests (SolverConfig::active_tolerance): the last
// solve of its separate problem hardly gained anything, and its cost is still
// about the same. Colours, planes and poses that it depends on move the cost,
// so that is what wakes it: many small changes add up, as the cost is compared
// with that after the last solve and not with that of the last phase.
//
// Nothing rests for long: what all keyframes share, the alternation finds by
// many small gains, and would not find if they stayed where they are.
#pragma once

#include <ceres/solver.h>

namespace facet {

// What a problem remembers of its last solve.
struct RestMemory {
  double cost = -1;  // after it; < 0: solve in the next phase
  int phases = 0;    // rested since
};

// A change of the cost by this many tolerances wakes. What comes from outside
// is mostly noise that a problem cannot follow, hence more than its own gain.
constexpr double kWakeFactor = 10;

// So many phases of its kind, and it is solved again.
constexpr int kMaxRest = 3;

// Whether a problem that now has the cost `cost` rests, which is counted.
bool Rests(double cost, double tolerance, RestMemory* memory);

// What a solve from `cost_before` to `cost` leaves behind. `cost` is that of
// the state that is kept: cost_before where the result was undone.
RestMemory RestAfter(const ceres::Solver::Summary& solved,
                     double cost_before,
                     double cost,
                     double tolerance);

}  // namespace facet
