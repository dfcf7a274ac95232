// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Depth images: where they cannot be trusted, and how they look from the
// colour camera. Depth images are CV_32F in metres with 0 = missing.
#pragma once

#include <opencv2/core.hpp>

#include "rgbd/camera.h"

namespace facet {

// Pixels within `dilate_px` (square neighbourhood) of a depth discontinuity, as
// CV_8U 255, else 0 (method, ch. 6 rule 6). A discontinuity lies between
// 4-neighbours when one of them is missing and the other is not, or when their
// depths z1 <= z2 differ by more than max(jump_m, jump_rel z1); both pixels
// count. Two missing pixels and the image border are no discontinuity.
cv::Mat DepthEdgeMask(const cv::Mat& depth,
                      double jump_m,
                      double jump_rel,
                      int dilate_px);

// Pixels within `dilate_px` of a place where a rendered surface breaks off and
// another one, nearer or farther, goes on: CV_8U 255, else 0. `depth` is a
// z-buffer without noise (0 = nothing). Unlike DepthEdgeMask this finds steps
// that are low against the slope of a surface: 1/z is linear in the image of a
// plane, so it is continued from both sides to the middle between neighbouring
// pixels; there a crease agrees, and a step of more than max(jump_m,
// jump_rel z) does not.
cv::Mat SurfaceEdgeMask(const cv::Mat& depth,
                        double jump_m,
                        double jump_rel,
                        int dilate_px);

// Standard deviation of the axial noise of a structured-light sensor at depth
// z [m], in metres (Nguyen et al. 2012): 0.0012 + 0.0019 (z - 0.4)^2.
template <typename T>
T DepthSigma(T z) {
  return T(0.0012) + T(0.0019) * (z - T(0.4)) * (z - T(0.4));
}

// The depth as the colour camera would measure it: CV_32F of the size of
// calibration.color, z in the colour camera [m], 0 = nothing there.
// Neighbouring depth pixels on one surface span triangles that are rasterised
// (1/z is linear in the image), so that a larger colour image gets no pinholes;
// the nearest surface wins. No triangle spans a depth jump above max(5 cm, 3 %
// z); pixels beside jumps are splatted singly. `depth` has the size of
// calibration.depth.
cv::Mat WarpDepthToColor(const cv::Mat& depth,
                         const RgbdCalibration& calibration);

// The colour image as the depth camera would see it.
struct RegisteredColor {
  cv::Mat color;  // CV_8UC3, size of calibration.depth
  // CV_8U: 255 where the colour camera sees the surface at that depth pixel; 0
  // where depth is missing, something hides it from the colour camera, or it
  // projects outside the colour image.
  cv::Mat seen;
};

// Looks every depth pixel up in `color` (CV_8UC3, size of calibration.color),
// bilinearly. Hidden is what lies more than max(5 cm, 3 % z) behind
// WarpDepthToColor.
RegisteredColor RegisterColorToDepth(const cv::Mat& color,
                                     const cv::Mat& depth,
                                     const RgbdCalibration& calibration);

}  // namespace facet
