// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The colour images of all keyframes, decoded once and kept: 3 bytes a pixel, 7
// with the smooth images (185 frames of 640 x 480: 0.4 GB). With a store in a
// file that is disk; who reads many images releases each (ReleasePages).
#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <vector>

#include "rgbd/image_store.h"
#include "rgbd/sequence.h"
#include "texture/exposure.h"

namespace facet {

// By keyframe; all of the size of the colour camera.
struct KeyframeImages {
  std::vector<cv::Mat> rgb;  // CV_8UC3, RGB order
  // What the optimisation reads, empty before and after it: luma after a
  // Gaussian of `sigma` px, CV_32F in [0, 1].
  std::vector<cv::Mat> smooth;
  // `smooth` has these applied, `rgb` is as taken. May be empty: all as taken.
  std::vector<Exposure> exposures;
  ImageStore store;  // where they are held

  size_t size() const { return rgb.size(); }
  Exposure ExposureOf(size_t keyframe) const {
    return exposures.empty() ? Exposure() : exposures[keyframe];
  }
};

// Unsmoothed luma, CV_32F in [0, 1], with the exposure applied. Releases the
// colours.
cv::Mat LumaOf(const KeyframeImages& images, size_t keyframe);

// The red, green and blue images of a keyframe as floats, nominally in [0, 1],
// with the exposure applied, after a Gaussian of `sigma` px. Releases the
// colours.
std::array<cv::Mat, 3> SmoothChannels(const cv::Mat& rgb,
                                      const Exposure& exposure,
                                      double sigma);

// The colours alone. `keyframes` are indices into sequence.frames(). Throws
// InputError when an image does not decode.
KeyframeImages LoadKeyframeColors(const RgbdSequence& sequence,
                                  const std::vector<int>& keyframes,
                                  const ImageStore& store = ImageStore());

// Sets the exposures, one a keyframe or none, and makes the smooth images anew.
void SetExposures(const std::vector<Exposure>& exposures,
                  double sigma,
                  KeyframeImages* images);

// Pyramid level `level` (geometry/pinhole.h): colours and luma are means
// over squares of 2^level pixels, what does not fill one at the right and lower
// border is left out; `smooth` is of `sigma` px of that level.
KeyframeImages PyramidLevel(const KeyframeImages& images,
                            int level,
                            double sigma);

}  // namespace facet
