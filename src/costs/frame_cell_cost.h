// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// E_c of the texels of one keyframe that fall into one cell of its warp
// lattice, compressed (costs/compressed_block.h): the production block of the
// (T, F) step.
//
// Residual    15 rows with warp, 7 without
// Parameters  pose cam_from_world                       7  (se3_manifold.h)
//             with warp: f00, f10, f01, f11 of the cell 2 each [px]
// Constants   plane points q and colours C of the texels
// Weight      `weight` multiplies the squared residuals (texel area weight)
// Texels keep the cell they had at construction: the bilinear polynomial
// extends smoothly beyond its cell.
// Reference   costs/photometric.h; test: tests/costs/frame_cell_cost_test.cc
#pragma once

#include <ceres/cost_function.h>

#include <vector>

#include "costs/photo_kernel.h"
#include "costs/se3_manifold.h"
#include "geometry/pinhole.h"
#include "geometry/warp_grid.h"

namespace facet {

// Sets intrinsics, size and lattice of `frame`.
void SetFrameCamera(const Pinhole& camera,
                    const WarpLattice& lattice,
                    PhotoFrame* frame);

// Sets rotation and translation of `frame` from a pose block; world coordinates
// of the kernel are relative to `origin`.
void SetFramePose(const double* pose,
                  const Eigen::Vector3d& origin,
                  PhotoFrame* frame);

class FrameCellCost : public ceres::CostFunction {
 public:
  // `frame` gives image, intrinsics and lattice (its pose and warp pointer are
  // ignored); `ids` select the texels, relative to `origin`. Nothing is copied:
  // all must outlive the cost. `with_warp` = the four vertices are parameters.
  FrameCellCost(const PhotoFrame& frame,
                const Eigen::Vector3d& origin,
                int cell_a,
                int cell_b,
                const PhotoTexel* texels,
                const uint32_t* ids,
                size_t num_ids,
                bool with_warp,
                double weight);

  bool Evaluate(double const* const* parameters,
                double* residuals,
                double** jacobians) const override;

 private:
  PhotoFrame frame_;
  Eigen::Vector3d origin_;
  int cell_a_, cell_b_;
  const PhotoTexel* texels_;
  const uint32_t* ids_;
  size_t num_ids_;
  bool with_warp_;
  double weight_;
};

}  // namespace facet
