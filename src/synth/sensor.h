// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// What an RGB-D camera of the first Kinect's kind makes of exact colour and
// depth.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/pinhole.h"
#include "render/ray_scene.h"

namespace facet {

struct DepthSensorOptions {
  double min_depth_m = 0.4;  // nearer or farther is missing
  double max_depth_m = 4.5;
  double projector_baseline_m = 0.075;  // the projector is right of the camera
  double disparity_step_px = 0.125;     // at a focal length of 585 px
};

// The depth image of a structured-light sensor as 16-bit raw values (`shift`
// units per metre, 0 = missing).
//
//   sigma(z, th) = 0.0012 + 0.0019 (z - 0.4)^2
//                  + 0.0001 / sqrt(z) th^2 / (pi/2 - th)^2     [m]
//
// axial standard deviation of Nguyen, Izadi and Lovell 2012 at depth z and
// angle th between ray and surface, correlated over 3 x 3 px as block matching
// makes it; its lateral 0.8 px jitter frays depth edges. Then quantised in
// disparity f b / z. Missing: out of range, th above 80 degrees, shadows of the
// projector, a part of the pixels at depth edges; another part of these mixes
// near and far.
//
//   exact   depth [m], 0 = nothing
//   angle   between viewing ray and normal [rad]
std::vector<uint16_t> SenseDepth(const Pinhole& camera,
                                 const std::vector<float>& exact,
                                 const std::vector<float>& angle,
                                 double shift,
                                 uint64_t seed,
                                 const DepthSensorOptions& options);

struct ColorSensorOptions {
  double noise_grey = 1.5;  // standard deviation of every channel [0-255]
  double vignetting = 0;    // loss of light in the corners, 0.25 = a quarter
  double gain = 1;          // exposure
};

// 8-bit RGB from `exact` RGB in [0, 255], both row-major, 3 values a pixel.
std::vector<uint8_t> SenseColor(int width,
                                int height,
                                const std::vector<float>& exact,
                                uint64_t seed,
                                const ColorSensorOptions& options);

}  // namespace facet
