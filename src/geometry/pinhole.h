// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The pinhole camera without distortion.
//
//   pi(y) = (f_x y_x / y_z + c_x,  f_y y_y / y_z + c_y)      [px]
//
// Camera frame: x right, y down, z forward [m]. Pixel centres lie at integer
// coordinates: the image covers [-0.5, width - 0.5] x [-0.5, height - 0.5].
#pragma once

#include <Eigen/Core>

namespace facet {

struct Pinhole {
  double fx = 0, fy = 0, cx = 0, cy = 0;  // [px]
  int width = 0, height = 0;              // [px]

  // pi(y); y.z must not be 0.
  template <typename T>
  Eigen::Matrix<T, 2, 1> Project(const Eigen::Matrix<T, 3, 1>& y) const {
    return {fx * y.x() / y.z() + cx, fy * y.y() / y.z() + cy};
  }

  // The ray direction (z = 1) through pixel (u, v), camera frame.
  Eigen::Vector3d Unproject(double u, double v) const {
    return {(u - cx) / fx, (v - cy) / fy, 1.0};
  }

  // Is u at least `margin` px inside the outermost pixel centres?
  bool Contains(const Eigen::Vector2d& u, double margin = 0) const {
    return u.x() >= margin && u.y() >= margin && u.x() <= width - 1 - margin &&
           u.y() <= height - 1 - margin;
  }

  // The camera of pyramid level l: f / 2^l, (c + 0.5) / 2^l - 0.5.
  Pinhole Level(int level) const {
    const double s = 1.0 / (1 << level);
    return {fx * s,
            fy * s,
            (cx + 0.5) * s - 0.5,
            (cy + 0.5) * s - 0.5,
            width >> level,
            height >> level};
  }
};

}  // namespace facet
