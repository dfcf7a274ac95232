// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "problems/rest.h"

#include <cmath>

namespace facet {

bool Rests(double rest, double cost, double tolerance) {
  return tolerance > 0 && rest >= 0 &&
         std::abs(cost - rest) <= kWakeFactor * tolerance * rest;
}

double RestAfter(const ceres::Solver::Summary& solved,
                 double cost_before,
                 double cost,
                 double tolerance) {
  // Where every step failed, the next solve may succeed with the smaller
  // trust region that it inherits.
  const bool failed = solved.termination_type != ceres::CONVERGENCE &&
                      !(solved.final_cost < solved.initial_cost);
  const bool rests = !failed && cost_before - cost <= tolerance * cost_before;
  return rests ? cost : kAwake;
}

}  // namespace facet
