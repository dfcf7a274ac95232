// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// E_c: photometric term (paper, Eq. color), one observation: the readable
// reference and the oracle of the tests. Production: frame_cell_cost.h and
// plane_photometric_cost.h.
//
//   E_c = sum_i sum_{p in P_i} |C(p) - I_i(F_i(pi(T_i q)))|^2
//   q   = p - (n.p + w) n
//
// Residual    r = I(F(pi(T q))) - C                      1  [intensity 0-1]
// Parameters  pose cam_from_world  (q_xyzw, t)           7  (se3_manifold.h)
//             plane (n, d) about the anchor              4  (plane_manifold.h)
//             colour C                                   1
//             warp vertices f00, f10, f01, f11           2 each [px]
// Constants   p, anchor in world [m]; image, camera, lattice
// The texel keeps the warp cell given at construction. With OutOfImage::kDrop
// the residual is 0 outside the image and behind the camera.
#pragma once

#include <ceres/autodiff_cost_function.h>

#include <algorithm>

#include "costs/ceres_compat.h"
#include "costs/photo_kernel.h"
#include "geometry/pinhole.h"
#include "geometry/plane.h"
#include "geometry/warp_grid.h"

namespace facet {

class PhotometricCost {
 public:
  PhotometricCost(const SampledImage& image,
                  const Pinhole& camera,
                  const WarpLattice& lattice,
                  int cell_a,
                  int cell_b,
                  const Eigen::Vector3d& p,
                  const Eigen::Vector3d& anchor,
                  OutOfImage out_of_image = OutOfImage::kFreeze)
      : image_(image),
        camera_(camera),
        lattice_(lattice),
        cell_a_(cell_a),
        cell_b_(cell_b),
        p_(p),
        anchor_(anchor),
        drop_(out_of_image == OutOfImage::kDrop) {}

  template <typename T>
  bool operator()(const T* pose,
                  const T* plane,
                  const T* color,
                  const T* f00,
                  const T* f10,
                  const T* f01,
                  const T* f11,
                  T* residual) const {
    const Eigen::Map<const Eigen::Quaternion<T>> rotation(pose);
    const Eigen::Map<const Eigen::Matrix<T, 3, 1>> translation(pose + 4);
    const Eigen::Matrix<T, 3, 1> q = ProjectOntoPlane(plane, p_, anchor_);
    const Eigen::Matrix<T, 3, 1> y = rotation * q + translation;
    const Eigen::Matrix<T, 2, 1> u = camera_.Project(y);
    const T alpha = u.x() / lattice_.CellWidth() - T(cell_a_);
    const T beta = u.y() / lattice_.CellHeight() - T(cell_b_);
    const T one(1);
    T warped[2];
    for (int k = 0; k < 2; ++k) {
      warped[k] = u[k] + (one - alpha) * (one - beta) * f00[k] +
                  alpha * (one - beta) * f10[k] +
                  (one - alpha) * beta * f01[k] + alpha * beta * f11[k];
    }
    residual[0] = SampleImage(image_, warped[0], warped[1]) - color[0];
    if (drop_ && (ScalarPart(y.z()) <= 0.05 ||
                  SampleAt(image_, ScalarPart(warped[0]), ScalarPart(warped[1]))
                      .clamped)) {
      residual[0] = T(0);
    }
    return true;
  }

  static ceres::CostFunction* Create(const PhotometricCost& cost) {
    return new ceres::
        AutoDiffCostFunction<PhotometricCost, 1, 7, 4, 1, 2, 2, 2, 2>(
            new PhotometricCost(cost));
  }

 private:
  SampledImage image_;
  Pinhole camera_;
  WarpLattice lattice_;
  int cell_a_, cell_b_;
  Eigen::Vector3d p_, anchor_;
  bool drop_;
};

// The same with the plane (n, d) and the colour bound: a residual of the pose
// and warp step. Parameters: pose 7, and if `with_warp` f00, f10, f01, f11 of
// 2; else there is no warp.
class PhotometricFrameCost {
 public:
  PhotometricFrameCost(const PhotometricCost& cost,
                       const double* plane,
                       double color)
      : cost_(cost),
        plane_{plane[0], plane[1], plane[2], plane[3]},
        color_(color) {}

  template <typename T>
  bool operator()(const T* pose,
                  const T* f00,
                  const T* f10,
                  const T* f01,
                  const T* f11,
                  T* residual) const {
    const T plane[4] = {T(plane_[0]), T(plane_[1]), T(plane_[2]), T(plane_[3])};
    const T color(color_);
    return cost_(pose, plane, &color, f00, f10, f01, f11, residual);
  }

  template <typename T>
  bool operator()(const T* pose, T* residual) const {
    const T zero[2] = {T(0), T(0)};
    return (*this)(pose, zero, zero, zero, zero, residual);
  }

  static ceres::CostFunction* Create(const PhotometricFrameCost& cost,
                                     bool with_warp) {
    auto* copy = new PhotometricFrameCost(cost);
    if (!with_warp) {
      return new ceres::AutoDiffCostFunction<PhotometricFrameCost, 1, 7>(copy);
    }
    return new ceres::
        AutoDiffCostFunction<PhotometricFrameCost, 1, 7, 2, 2, 2, 2>(copy);
  }

 private:
  PhotometricCost cost_;
  double plane_[4];
  double color_;
};

// The same with pose, colour and warp vertices (8 numbers) bound: a residual of
// the plane step. Parameter: plane 4.
class PhotometricPlaneCost {
 public:
  PhotometricPlaneCost(const PhotometricCost& cost,
                       const double* pose,
                       double color,
                       const double* vertices)
      : cost_(cost), color_(color) {
    std::copy(pose, pose + 7, pose_);
    std::copy(vertices, vertices + 8, vertices_);
  }

  template <typename T>
  bool operator()(const T* plane, T* residual) const {
    T pose[7], f[8];
    for (int k = 0; k < 7; ++k) pose[k] = T(pose_[k]);
    for (int k = 0; k < 8; ++k) f[k] = T(vertices_[k]);
    const T color(color_);
    return cost_(pose, plane, &color, f, f + 2, f + 4, f + 6, residual);
  }

  static ceres::CostFunction* Create(const PhotometricPlaneCost& cost) {
    return new ceres::AutoDiffCostFunction<PhotometricPlaneCost, 1, 4>(
        new PhotometricPlaneCost(cost));
  }

 private:
  PhotometricCost cost_;
  double pose_[7], vertices_[8];
  double color_;
};

}  // namespace facet
