// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "texture/keyframe_images.h"

#include <opencv2/imgproc.hpp>

#include "util/parallel_for.h"

namespace facet {
namespace {

cv::Mat Smooth(const cv::Mat& image, double sigma) {
  if (!(sigma > 0)) return image;
  cv::Mat smooth;
  cv::GaussianBlur(
      image, smooth, cv::Size(), sigma, sigma, cv::BORDER_REFLECT_101);
  return smooth;
}

}  // namespace

std::array<cv::Mat, 3> SmoothChannels(const cv::Mat& rgb,
                                      const Exposure& exposure,
                                      double sigma) {
  std::array<cv::Mat, 3> channels;
  cv::split(rgb, channels.data());
  for (int c = 0; c < 3; ++c) {
    channels[c].convertTo(
        channels[c], CV_32F, exposure.gain[c] / 255.0, exposure.offset[c]);
    channels[c] = Smooth(channels[c], sigma);
  }
  return channels;
}

void SetExposures(const std::vector<Exposure>& exposures,
                  double sigma,
                  KeyframeImages* images) {
  images->exposures = exposures;
  ParallelFor(0, images->size(), [&](size_t k) {
    const Exposure exposure = images->ExposureOf(k);
    images->luma[k] =
        LumaFromRgb(images->rgb[k], exposure.gain, exposure.offset);
    images->smooth[k] = Smooth(images->luma[k], sigma);
  });
}

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
    images.smooth[k] = Smooth(images.luma[k], sigma);
  });
  return images;
}

KeyframeImages PyramidLevel(const KeyframeImages& images,
                            int level,
                            double sigma) {
  KeyframeImages reduced;
  reduced.exposures = images.exposures;
  const size_t n = images.size();
  reduced.rgb.resize(n);
  reduced.luma.resize(n);
  reduced.smooth.resize(n);
  ParallelFor(0, n, [&](size_t k) {
    const cv::Size size(images.luma[k].cols >> level,
                        images.luma[k].rows >> level);
    const cv::Rect whole_squares(
        0, 0, size.width << level, size.height << level);
    const auto reduce = [&](const cv::Mat& image, cv::Mat* out) {
      cv::resize(image(whole_squares), *out, size, 0, 0, cv::INTER_AREA);
    };
    reduce(images.rgb[k], &reduced.rgb[k]);
    reduce(images.luma[k], &reduced.luma[k]);
    reduced.smooth[k] = Smooth(reduced.luma[k], sigma);
  });
  return reduced;
}

}  // namespace facet
