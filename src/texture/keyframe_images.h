// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The colour images of all keyframes, decoded once and kept: 11 bytes a pixel
// (185 frames of 640 x 480: 0.6 GB with all three kinds).
#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <vector>

#include "rgbd/sequence.h"
#include "texture/exposure.h"

namespace facet {

// By keyframe; all of the size of the colour camera.
struct KeyframeImages {
  std::vector<cv::Mat> rgb;     // CV_8UC3, RGB order
  std::vector<cv::Mat> luma;    // CV_32F in [0, 1], unsmoothed
  std::vector<cv::Mat> smooth;  // luma after a Gaussian of `sigma` px
  // `luma` and `smooth` have these applied, `rgb` is as taken. May be empty:
  // all as taken.
  std::vector<Exposure> exposures;

  size_t size() const { return rgb.size(); }
  Exposure ExposureOf(size_t keyframe) const {
    return exposures.empty() ? Exposure() : exposures[keyframe];
  }
};

// The red, green and blue images of a keyframe as floats, nominally in [0, 1],
// with the exposure applied, after a Gaussian of `sigma` px.
std::array<cv::Mat, 3> SmoothChannels(const cv::Mat& rgb,
                                      const Exposure& exposure,
                                      double sigma);

// Sets the exposures, one a keyframe or none, and makes luma and smooth anew.
void SetExposures(const std::vector<Exposure>& exposures,
                  double sigma,
                  KeyframeImages* images);

// `keyframes` are indices into sequence.frames(). sigma = 0: smooth = luma
// (shared, not copied). Throws InputError when an image does not decode.
KeyframeImages LoadKeyframeImages(const RgbdSequence& sequence,
                                  const std::vector<int>& keyframes,
                                  double sigma);

// Pyramid level `level` (geometry/pinhole.h): `rgb` and `luma` are means over
// squares of 2^level pixels, what does not fill one at the right and lower
// border is left out; `smooth` is of `sigma` px of that level.
KeyframeImages PyramidLevel(const KeyframeImages& images,
                            int level,
                            double sigma);

}  // namespace facet
