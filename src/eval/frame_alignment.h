// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Refines the pose of one photo against a finished model, so that a model that
// is sharp but lies a few millimetres from the given pose is not punished for
// it (method, Sec. 11.2, "aligned").
//
// The model is rendered at the current pose T0. With the camera-frame point
// y of a model pixel, its luma M and the photo's luma I, both 0-1 and blurred,
//
//   r = I(pi(Exp(xi) y)) - (gain M + bias)
//   dr/d(omega, upsilon) = (y x h, h),   h = grad I . J_pi       (Sec. 7.2)
//
// is minimised by Gauss-Newton with a Huber loss over (xi, gain, bias); the
// model is rendered again at the pose found, several times, first with a
// coarse, then with a fine blur.
#pragma once

#include <vector>

#include "eval/photometric_metrics.h"

namespace facet {

struct AlignmentOptions {
  // One rendering each, Gaussian sigma [px].
  std::vector<double> blur_px = {2.0, 2.0, 0.8, 0.8, 0.8};
  int max_iterations = 15;             // a rendering
  double huber = 0.04;                 // of luma 0-1
  double max_depth_difference = 0.05;  // mask as in the metrics [m]
  // Beyond these the result does not count.
  double max_shift_m = 0.08;
  double max_angle_deg = 4;
  // About this many pixels are used, on a regular grid.
  int max_samples = 100000;
};

struct FrameAlignment {
  Pose cam_from_world;    // the refined pose; the given one if not accepted
  bool accepted = false;  // false also when too little is seen
  double shift_m = 0;     // of the camera centre, refined against given
  double angle_deg = 0;
  int iterations = 0;
};

// `photo` CV_8UC3 RGB and `sensor_depth` CV_32F [m] of the camera's size.
FrameAlignment AlignFrame(const TexturedMesh& model,
                          const RayScene& scene,
                          const Pinhole& camera,
                          const Pose& cam_from_world,
                          const cv::Mat& photo,
                          const cv::Mat& sensor_depth,
                          const AlignmentOptions& options);

}  // namespace facet
