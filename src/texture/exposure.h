// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Exposure of a keyframe: cameras with automatic exposure and white balance
// show the same surface brighter in one image than in the next. An affine map a
// channel takes an image to the common exposure of all:
//
//   I' = gain I + offset,   intensities in 0-1
//
// (the affine brightness model of direct visual odometry). Found by
// problems/exposure_calibration.h, then constant: E_c, warps, poses and final
// colours all work on I'.
#pragma once

#include <Eigen/Core>

namespace facet {

struct Exposure {
  Eigen::Array3f gain = Eigen::Array3f::Ones();  // red, green, blue
  Eigen::Array3f offset = Eigen::Array3f::Zero();

  // Colours in 0-255; may leave that range.
  Eigen::Vector3f Corrected(const Eigen::Vector3f& rgb) const {
    return (gain * rgb.array() + 255.0f * offset).matrix();
  }
};

}  // namespace facet
