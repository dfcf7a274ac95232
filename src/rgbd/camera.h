// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Calibration of an RGB-D camera: two pinholes and the rigid motion between
// them. They are different cameras of different sizes unless told otherwise.
#pragma once

#include "geometry/pinhole.h"
#include "geometry/pose.h"

namespace facet {

struct RgbdCalibration {
  Pinhole color;
  Pinhole depth;
  // y_color = E_color * E_depth^-1 * y_depth (method, Sec. 1.2).
  Pose color_from_depth;
  double depth_shift = 1000;  // raw depth units per metre
};

}  // namespace facet
