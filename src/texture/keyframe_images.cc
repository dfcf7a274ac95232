// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "texture/keyframe_images.h"

#include <opencv2/imgproc.hpp>

#include "util/parallel_for.h"

namespace facet {

KeyframeImages LoadKeyframeImages(const RgbdSequence& sequence,
                                  const std::vector<int>& keyframes,
                                  double sigma) {
  KeyframeImages images;
  images.rgb.resize(keyframes.size());
  images.luma.resize(keyframes.size());
  images.smooth.resize(keyframes.size());
  ParallelFor(0, keyframes.size(), [&](size_t k) {
    images.rgb[k] = sequence.LoadColor(keyframes[k]);
    images.luma[k] = LumaFromRgb(images.rgb[k]);
    if (sigma > 0) {
      cv::GaussianBlur(images.luma[k],
                       images.smooth[k],
                       cv::Size(),
                       sigma,
                       sigma,
                       cv::BORDER_REFLECT_101);
    } else {
      images.smooth[k] = images.luma[k];
    }
  });
  return images;
}

}  // namespace facet
