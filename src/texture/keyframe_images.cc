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

cv::Mat LumaOf(const KeyframeImages& images, size_t keyframe) {
  const Exposure exposure = images.ExposureOf(keyframe);
  const cv::Mat& rgb = images.rgb[keyframe];
  cv::Mat luma = LumaFromRgb(rgb, exposure.gain, exposure.offset);
  ReleasePages(rgb);
  return luma;
}

std::array<cv::Mat, 3> SmoothChannels(const cv::Mat& rgb,
                                      const Exposure& exposure,
                                      double sigma) {
  std::array<cv::Mat, 3> channels;
  cv::split(rgb, channels.data());
  ReleasePages(rgb);
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
  images->smooth.resize(images->size());
  ParallelFor(0, images->size(), [&](size_t k) {
    images->smooth[k] = images->store.Keep(Smooth(LumaOf(*images, k), sigma));
  });
}

KeyframeImages LoadKeyframeColors(const RgbdSequence& sequence,
                                  const std::vector<int>& keyframes,
                                  const ImageStore& store) {
  KeyframeImages images;
  images.store = store;
  images.rgb.resize(keyframes.size());
  ParallelFor(0, keyframes.size(), [&](size_t k) {
    images.rgb[k] = store.Keep(sequence.LoadColor(keyframes[k]));
  });
  return images;
}

KeyframeImages PyramidLevel(const KeyframeImages& images,
                            int level,
                            double sigma) {
  KeyframeImages reduced;
  reduced.exposures = images.exposures;
  reduced.store = images.store;
  const size_t n = images.size();
  reduced.rgb.resize(n);
  reduced.smooth.resize(n);
  ParallelFor(0, n, [&](size_t k) {
    const cv::Size size(images.rgb[k].cols >> level,
                        images.rgb[k].rows >> level);
    const cv::Rect whole_squares(
        0, 0, size.width << level, size.height << level);
    const auto reduce = [&](const cv::Mat& image) {
      cv::Mat out;
      cv::resize(image(whole_squares), out, size, 0, 0, cv::INTER_AREA);
      return out;
    };
    reduced.rgb[k] = images.store.Keep(reduce(images.rgb[k]));
    reduced.smooth[k] =
        images.store.Keep(Smooth(reduce(LumaOf(images, k)), sigma));
  });
  return reduced;
}

}  // namespace facet
