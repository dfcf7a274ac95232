// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "costs/plane_photometric_cost.h"

#include <algorithm>
#include <cmath>

#include "costs/compressed_block.h"

namespace facet {

PlanePhotometricCost::PlanePhotometricCost(
    const std::vector<PhotoFrame>& frames,
    const std::vector<PlaneSegment>& segments,
    const PhotoTexel* texels,
    const Eigen::Vector3d& anchor,
    double weight)
    : frames_(frames), segments_(segments), texels_(texels), weight_(weight) {
  for (int k = 0; k < 3; ++k) anchor_[k] = static_cast<float>(anchor[k]);
}

bool PlanePhotometricCost::Evaluate(double const* const* parameters,
                                    double* residuals,
                                    double** jacobians) const {
  float plane[4];
  for (int k = 0; k < 4; ++k) plane[k] = static_cast<float>(parameters[0][k]);
  const bool want_jacobian = jacobians && jacobians[0];
  double gram[GramSize(4)] = {};
  double squares = 0;
  PhotoCounts counts;
  for (const PlaneSegment& segment : segments_) {
    squares += GetPhotoKernel().plane_segment(frames_[segment.keyframe],
                                              plane,
                                              anchor_,
                                              texels_,
                                              segment.ids,
                                              segment.num_ids,
                                              want_jacobian ? gram : nullptr,
                                              &counts);
  }
  if (!want_jacobian) {
    std::fill(residuals, residuals + 5, 0.0);
    residuals[0] = std::sqrt(weight_ * squares);
    return true;
  }
  CompressGram(4, gram, jacobians[0], residuals);
  const double scale = std::sqrt(weight_);
  for (int i = 0; i < 5; ++i) residuals[i] *= scale;
  for (int i = 0; i < 20; ++i) jacobians[0][i] *= scale;
  return true;
}

}  // namespace facet
