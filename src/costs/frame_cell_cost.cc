// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "costs/frame_cell_cost.h"

#include <algorithm>
#include <cmath>

#include "costs/compressed_block.h"

namespace facet {

void SetFrameCamera(const Pinhole& camera,
                    const WarpLattice& lattice,
                    PhotoFrame* frame) {
  frame->width = camera.width;
  frame->height = camera.height;
  frame->fx = static_cast<float>(camera.fx);
  frame->fy = static_cast<float>(camera.fy);
  frame->cx = static_cast<float>(camera.cx);
  frame->cy = static_cast<float>(camera.cy);
  frame->columns = lattice.columns;
  frame->rows = lattice.rows;
  frame->inverse_cell_width = static_cast<float>(1 / lattice.CellWidth());
  frame->inverse_cell_height = static_cast<float>(1 / lattice.CellHeight());
}

void SetFramePose(const double* pose,
                  const Eigen::Vector3d& origin,
                  PhotoFrame* frame) {
  const Pose cam_from_world = PoseFromBlock(pose);
  const Eigen::Matrix3d r = cam_from_world.RotationMatrix();
  const Eigen::Vector3d t = cam_from_world * origin;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      frame->r[3 * i + j] = static_cast<float>(r(i, j));
    }
    frame->t[i] = static_cast<float>(t[i]);
  }
}

FrameCellCost::FrameCellCost(const PhotoFrame& frame,
                             const Eigen::Vector3d& origin,
                             int cell_a,
                             int cell_b,
                             const PhotoTexel* texels,
                             const uint32_t* ids,
                             size_t num_ids,
                             bool with_warp,
                             double weight)
    : frame_(frame),
      origin_(origin),
      cell_a_(cell_a),
      cell_b_(cell_b),
      texels_(texels),
      ids_(ids),
      num_ids_(num_ids),
      with_warp_(with_warp),
      weight_(weight) {
  mutable_parameter_block_sizes()->push_back(kPoseSize);
  if (with_warp_) {
    for (int k = 0; k < 4; ++k) mutable_parameter_block_sizes()->push_back(2);
  }
  set_num_residuals(with_warp_ ? 15 : 7);
}

bool FrameCellCost::Evaluate(double const* const* parameters,
                             double* residuals,
                             double** jacobians) const {
  PhotoFrame frame = frame_;
  SetFramePose(parameters[0], origin_, &frame);
  float vertices[8];
  frame.warp = nullptr;
  if (with_warp_) {
    for (int k = 0; k < 8; ++k) {
      vertices[k] = static_cast<float>(parameters[1 + k / 2][k % 2]);
    }
    frame.warp = vertices;
  }
  const int n = with_warp_ ? 14 : 6;
  double gram[GramSize(14)] = {};
  PhotoCounts counts;
  const double squares =
      GetPhotoKernel().frame_cell(frame,
                                  static_cast<float>(cell_a_),
                                  static_cast<float>(cell_b_),
                                  texels_,
                                  ids_,
                                  num_ids_,
                                  with_warp_,
                                  jacobians ? gram : nullptr,
                                  &counts);
  if (!jacobians) {
    std::fill(residuals, residuals + n + 1, 0.0);
    residuals[0] = std::sqrt(weight_ * squares);
    return true;
  }
  double rows[15 * 14];
  CompressGram(n, gram, rows, residuals);
  const double scale = std::sqrt(weight_);
  for (int i = 0; i <= n; ++i) residuals[i] *= scale;
  const Eigen::Map<
      const Eigen::
          Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>
      u(rows, n + 1, n);
  if (jacobians[0]) {
    Eigen::Map<
        Eigen::Matrix<double, Eigen::Dynamic, kPoseSize, Eigen::RowMajor>>
        j(jacobians[0], n + 1, kPoseSize);
    j.noalias() = scale * u.leftCols<6>() * LeftPoseLift(parameters[0]);
  }
  for (int k = 0; with_warp_ && k < 4; ++k) {
    if (!jacobians[1 + k]) continue;
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor>> j(
        jacobians[1 + k], n + 1, 2);
    j = scale * u.middleCols<2>(6 + 2 * k);
  }
  return true;
}

}  // namespace facet
