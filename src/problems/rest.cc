// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "problems/rest.h"

#include <cmath>

namespace facet {

bool Rests(double cost, double tolerance, RestMemory* memory) {
  if (!(tolerance > 0) || memory->cost < 0 || memory->phases >= kMaxRest ||
      !(std::abs(cost - memory->cost) <=
        kWakeFactor * tolerance * memory->cost)) {
    return false;
  }
  ++memory->phases;
  return true;
}

RestMemory RestAfter(const ceres::Solver::Summary& solved,
                     double cost_before,
                     double cost,
                     double tolerance) {
  // Where every step failed, the next solve may succeed with the smaller
  // trust region that it inherits.
  const bool failed = solved.termination_type != ceres::CONVERGENCE &&
                      !(solved.final_cost < solved.initial_cost);
  RestMemory memory;
  if (!failed && cost_before - cost <= tolerance * cost_before) {
    memory.cost = cost;
  }
  return memory;
}

}  // namespace facet
