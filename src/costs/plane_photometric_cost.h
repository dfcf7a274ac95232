// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// E_c of all observations of one plane, compressed: the production block of the
// plane step.
//
// Residual    5 rows
// Parameters  plane (n_x, n_y, n_z, d) about its anchor  4  (plane_manifold.h)
// Constants   texel points p and colours C; keyframe poses and warps
// Weight      `weight` multiplies the squared residuals (texel area weight)
// Reference   costs/photometric.h; test:
// tests/costs/plane_photometric_cost_test.cc
#pragma once

#include <ceres/sized_cost_function.h>

#include <Eigen/Core>
#include <vector>

#include "costs/photo_kernel.h"

namespace facet {

// Observations of consecutive texels of one plane by one keyframe.
struct PlaneSegment {
  int keyframe = 0;
  const uint32_t* ids = nullptr;
  size_t num_ids = 0;
};

class PlanePhotometricCost : public ceres::SizedCostFunction<5, 4> {
 public:
  // `texels` hold mesh points p and `anchor` the plane's anchor, both relative
  // to the origin that `frames` were set up with. All must outlive the cost.
  PlanePhotometricCost(const std::vector<PhotoFrame>& frames,
                       const std::vector<PlaneSegment>& segments,
                       const PhotoTexel* texels,
                       const Eigen::Vector3d& anchor,
                       double weight);

  bool Evaluate(double const* const* parameters,
                double* residuals,
                double** jacobians) const override;

 private:
  const std::vector<PhotoFrame>& frames_;
  const std::vector<PlaneSegment>& segments_;
  const PhotoTexel* texels_;
  float anchor_[3];
  double weight_;
};

}  // namespace facet
