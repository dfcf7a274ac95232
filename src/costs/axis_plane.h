// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// A plane that should be perpendicular to a given axis: a wall, floor or table
// of a room built at right angles. The worked example of
// docs/add-a-residual.md.
//
//   E = weight |n x a|^2 = weight sin^2(angle between normal and axis)
//
// Residual    sqrt(weight) n x a                             3
//             a    axis, world, unit; its sign does not matter
// Parameters  plane (n, d) about its anchor                  4
// The length of n cancels: PlaneKind::kRaw4 leaves it free.
#pragma once

#include <ceres/autodiff_cost_function.h>

#include <Eigen/Geometry>
#include <cmath>

namespace facet {

class AxisPlaneCost {
 public:
  AxisPlaneCost(const Eigen::Vector3d& axis, double weight)
      : weighted_axis_(std::sqrt(weight) * axis.normalized()) {}

  template <typename T>
  bool operator()(const T* plane, T* residual) const {
    using Vector3 = Eigen::Matrix<T, 3, 1>;
    const Vector3 n(plane[0], plane[1], plane[2]);
    Eigen::Map<Vector3> r(residual);
    r = n.normalized().cross(weighted_axis_.cast<T>());
    return true;
  }

  static ceres::CostFunction* Create(const Eigen::Vector3d& axis,
                                     double weight) {
    return new ceres::AutoDiffCostFunction<AxisPlaneCost, 3, 4>(
        new AxisPlaneCost(axis, weight));
  }

 private:
  Eigen::Vector3d weighted_axis_;
};

}  // namespace facet
