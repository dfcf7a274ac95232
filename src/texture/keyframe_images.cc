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

std::array<cv::Mat, 3> SmoothChannels(const cv::Mat& rgb, double sigma) {
  std::array<cv::Mat, 3> channels;
  cv::split(rgb, channels.data());
  for (cv::Mat& channel : channels) {
    channel.convertTo(channel, CV_32F, 1.0 / 255);
    channel = Smooth(channel, sigma);
  }
  return channels;
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
