// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cmath>
#include <utility>

#include "util/random.h"

namespace facet {

// A smooth random curve over t in [0, 1]: five sines of random phase with
// between `slowest` and `fastest` periods; mean about 0, standard deviation
// about 1.
class Wander {
 public:
  Wander(double slowest, double fastest, Random* random) {
    for (auto& [periods, phase] : waves_) {
      periods = random->Uniform(slowest, fastest);
      phase = random->Uniform(0, kTurn);
    }
  }

  double operator()(double t) const {
    double sum = 0;
    for (const auto& [periods, phase] : waves_) {
      sum += std::sin(kTurn * periods * t + phase);
    }
    return sum / std::sqrt(0.5 * waves_.size());
  }

 private:
  static constexpr double kTurn = 6.283185307179586;
  std::array<std::pair<double, double>, 5> waves_;
};

}  // namespace facet
