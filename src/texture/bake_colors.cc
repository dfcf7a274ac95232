// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "texture/bake_colors.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "rgbd/blur.h"
#include "util/parallel_for.h"

namespace facet {
namespace {

float Luma(const Eigen::Array4f& rgb) {
  return (0.299f * rgb.x() + 0.587f * rgb.y() + 0.114f * rgb.z()) / 255.0f;
}

}  // namespace

std::vector<float> Sharpness(const KeyframeImages& images, double power) {
  std::vector<float> sharpness(images.size(), 1.0f);
  if (!(power > 0) || images.size() == 0) return sharpness;
  ParallelFor(0, images.size(), [&](size_t k) {
    const cv::Mat luma = LumaOf(images, k);
    const ImageView<float> view = {luma.ptr<float>(),
                                   luma.cols,
                                   luma.rows,
                                   static_cast<ptrdiff_t>(luma.step1())};
    sharpness[k] = static_cast<float>(1 - CreteBlur(view));
  });
  std::vector<float> sorted = sharpness;
  std::sort(sorted.begin(), sorted.end());
  const float median = sorted[sorted.size() / 2];
  for (float& s : sharpness) {
    s = median > 0 ? std::max(s / median, 1e-3f) : 1.0f;
  }
  return sharpness;
}

size_t DropOutliers(size_t n,
                    size_t owned,
                    size_t num_views,
                    float limit,
                    std::vector<ColorSample>* samples) {
  size_t dropped = 0;
  std::vector<std::pair<float, float>> lumas;  // luma, weight
  for (size_t i = 0; i < n; ++i) {
    lumas.clear();
    float total = 0;
    for (size_t v = 0; v < num_views; ++v) {
      const ColorSample& sample = (*samples)[n * v + i];
      if (!(sample.weight > 0)) continue;
      lumas.emplace_back(Luma(sample.color), sample.weight);
      total += sample.weight;
    }
    if (lumas.size() < 2) continue;
    std::sort(lumas.begin(), lumas.end());
    float sum = 0, median = lumas.back().first;
    for (const auto& [luma, weight] : lumas) {
      sum += weight;
      if (2 * sum < total) continue;
      median = luma;
      break;
    }
    for (size_t v = 0; v < num_views; ++v) {
      ColorSample& sample = (*samples)[n * v + i];
      if (!(sample.weight > 0)) continue;
      if (std::abs(Luma(sample.color) - median) <= limit) continue;
      sample.weight = 0;
      dropped += i < owned;
    }
  }
  return dropped;
}

}  // namespace facet
