// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Shape of triangles, and whether moving one corner is admissible (method,
// Sec. 3.5). Internal to the simplification.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "mesh/simplify.h"

namespace facet {

// 4 sqrt(3) area / (l1^2 + l2^2 + l3^2): 1 for an equilateral triangle, 0 for a
// degenerate one.
inline double Compactness(const Eigen::Vector3d& p0,
                          const Eigen::Vector3d& p1,
                          const Eigen::Vector3d& p2) {
  const double lengths = (p1 - p0).squaredNorm() + (p2 - p1).squaredNorm() +
                         (p0 - p2).squaredNorm();
  if (!(lengths > 0)) return 0;
  const double area = 0.5 * (p1 - p0).cross(p2 - p0).norm();
  return 6.928203230275509 * area / lengths;
}

constexpr double kNoNormal = 2e-12;  // twice the area of such a face [m^2]

struct ShapeLimits {
  // Those that no collapse may break.
  static ShapeLimits Hard(const SimplifyOptions& options) {
    return {options.min_height_share, std::cos(89 * M_PI / 180), -1, 2e-4};
  }
  // Those that a collapse keeps or pays for.
  static ShapeLimits Soft(const SimplifyOptions& options) {
    return {options.min_height_share,
            std::cos(options.max_turn_deg * M_PI / 180),
            std::cos(options.max_away_deg * M_PI / 180),
            options.min_compactness};
  }

  double min_height_share, min_turn_cos, min_facing_cos, min_compactness;
};

// May corner `from` of the triangle (from, p2, p3), counter-clockwise, move to
// `to`? `facing`, of any length, is where the dense surface looks that the
// triangle stands for. A face without a normal may become anything that has
// one.
inline bool MayMoveCorner(const Eigen::Vector3d& from,
                          const Eigen::Vector3d& to,
                          const Eigen::Vector3d& p2,
                          const Eigen::Vector3d& p3,
                          const Eigen::Vector3d& facing,
                          const ShapeLimits& limits) {
  const Eigen::Vector3d base = p3 - p2;
  const Eigen::Vector3d old_cross = base.cross(from - p2);
  const Eigen::Vector3d new_cross = base.cross(to - p2);
  const double old_norm = old_cross.norm();
  const double new_norm = new_cross.norm();
  const double base_sq = base.squaredNorm();
  const double lengths =
      base_sq + (to - p2).squaredNorm() + (to - p3).squaredNorm();
  // 2 sqrt(3) |cross| / lengths is the compactness.
  const double new_compact = 3.4641016151377544 * new_norm / lengths;
  if (!(new_compact > 1e-4)) return false;

  // A face that looks away from its surface, or has no area, may become
  // anything that lies well. Cosines times the length of `facing`.
  const double min_facing = limits.min_facing_cos * facing.norm();
  const double new_facing = new_cross.dot(facing) / new_norm;
  const bool old_away =
      !(old_norm > kNoNormal) || old_cross.dot(facing) < min_facing * old_norm;
  if (old_away && new_facing >= min_facing &&
      new_compact >= limits.min_compactness) {
    return true;
  }
  if (!(old_norm > kNoNormal)) return false;
  // Heights over the same base are as the areas; the new one is measured along
  // the old normal's in-plane direction, so it is negative beyond the base.
  const double turned = new_cross.dot(old_cross);
  if (!(turned > limits.min_height_share * old_norm * old_norm)) return false;
  if (turned < limits.min_turn_cos * new_norm * old_norm) return false;
  if (new_facing < min_facing &&
      new_facing * old_norm < old_cross.dot(facing)) {
    return false;
  }
  if (new_compact < limits.min_compactness) {
    const double old_lengths =
        base_sq + (from - p2).squaredNorm() + (from - p3).squaredNorm();
    if (new_compact < 3.4641016151377544 * old_norm / old_lengths) return false;
  }
  return true;
}

}  // namespace facet
