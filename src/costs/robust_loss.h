// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Robust losses of a single observation: E_c = sum rho(r^2) with (as in Ceres)
// rho(0) = 0, rho'(0) = 1 and a scale c in intensities:
//
//   squared  s
//   Huber    s up to c^2, then 2 c sqrt(s) - c^2
//   Cauchy   c^2 log(1 + s / c^2)
//   Tukey    c^2/3 (1 - (1 - s / c^2)^3) up to c^2, then c^2/3
//
// All are concave in s: rho(s) >= s rho'(s), so that the rows
// sqrt(rho') [J r] of a block never explain more than its cost, and means
// weighted with rho' never raise sum rho (problems/tile_samples.h).
#pragma once

#include <cmath>

#include "costs/photo_kernel.h"

namespace facet {

// rho(s), s = r^2.
inline double LossValue(LossKind kind, double scale, double s) {
  const double c2 = scale * scale;
  switch (kind) {
    case LossKind::kSquared:
      return s;
    case LossKind::kHuber:
      return s <= c2 ? s : 2 * scale * std::sqrt(s) - c2;
    case LossKind::kCauchy:
      return c2 * std::log1p(s / c2);
    case LossKind::kTukey: {
      const double x = s < c2 ? s / c2 : 1.0;
      return c2 / 3 * x * (3 + x * (x - 3));
    }
  }
  return s;
}

// rho'(s): the weight of an observation.
inline double LossWeight(LossKind kind, double scale, double s) {
  const double c2 = scale * scale;
  switch (kind) {
    case LossKind::kSquared:
      return 1;
    case LossKind::kHuber:
      return s <= c2 ? 1.0 : scale / std::sqrt(s);
    case LossKind::kCauchy:
      return 1 / (1 + s / c2);
    case LossKind::kTukey: {
      const double t = s < c2 ? 1 - s / c2 : 0.0;
      return t * t;
    }
  }
  return 1;
}

}  // namespace facet
