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
// The texel keeps the warp cell given at construction.
#pragma once

#include <ceres/autodiff_cost_function.h>

#include "costs/ceres_compat.h"
#include "geometry/pinhole.h"
#include "geometry/plane.h"
#include "geometry/warp_grid.h"

namespace facet {

class PhotometricCost {
 public:
  PhotometricCost(const ImageView<float>& image,
                  const Pinhole& camera,
                  const WarpLattice& lattice,
                  int cell_a,
                  int cell_b,
                  const Eigen::Vector3d& p,
                  const Eigen::Vector3d& anchor)
      : image_(image),
        camera_(camera),
        lattice_(lattice),
        cell_a_(cell_a),
        cell_b_(cell_b),
        p_(p),
        anchor_(anchor) {}

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
    return true;
  }

  static ceres::CostFunction* Create(const PhotometricCost& cost) {
    return new ceres::AutoDiffCostFunction<PhotometricCost, 1, 7, 4, 1, 2, 2, 2,
                                           2>(new PhotometricCost(cost));
  }

 private:
  ImageView<float> image_;
  Pinhole camera_;
  WarpLattice lattice_;
  int cell_a_, cell_b_;
  Eigen::Vector3d p_, anchor_;
};

}  // namespace facet
