// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The residual of costs/photometric.h with its derivatives written out, in
// double, in two forms that are not worth having outside the benchmarks: a cost
// function an observation, and one a warp cell with a row an observation.
#pragma once

#include <ceres/cost_function.h>
#include <ceres/sized_cost_function.h>

#include <vector>

#include "costs/se3_manifold.h"
#include "geometry/image_sampler.h"
#include "geometry/pinhole.h"
#include "geometry/warp_grid.h"

namespace facet {

// What the observations of a keyframe in one warp cell have in common.
struct CellView {
  SampledImage image;
  Pinhole camera;
  WarpLattice lattice;
  int a = 0, b = 0;
};

struct ObservedPoint {
  Eigen::Vector3d q;  // plane point, world [m]
  double color = 0;
};

// r, and with `row` its derivatives by (omega, upsilon | f00 f10 f01 f11): 14.
double EvaluateObservation(const CellView& view,
                           const Eigen::Matrix3d& rotation,
                           const Eigen::Vector3d& translation,
                           double const* const* vertices,
                           const ObservedPoint& point,
                           double* row);

class AnalyticCost : public ceres::SizedCostFunction<1, kPoseSize, 2, 2, 2, 2> {
 public:
  // `view` must outlive the cost.
  AnalyticCost(const CellView& view, const ObservedPoint& point)
      : view_(view), point_(point) {}
  bool Evaluate(double const* const* parameters,
                double* residuals,
                double** jacobians) const override;

 private:
  const CellView& view_;
  ObservedPoint point_;
};

class BatchedCost : public ceres::CostFunction {
 public:
  // `view` must outlive the cost.
  BatchedCost(const CellView& view, std::vector<ObservedPoint> points);
  bool Evaluate(double const* const* parameters,
                double* residuals,
                double** jacobians) const override;

 private:
  const CellView& view_;
  std::vector<ObservedPoint> points_;
};

}  // namespace facet
