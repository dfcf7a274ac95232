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

float Luma(const Eigen::Array3f& rgb) {
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

void ColorSums::Add(size_t block,
                    const float* const rgb[3],
                    const float* weight,
                    const ByteExposure* exposure) {
  // Copied: the compiler must see that no sum is a weight.
  float w[kBlock];
  std::copy_n(weight, kBlock, w);
  float* sum = rows_.data() + kBlock * block;
  for (size_t i = 0; i < kBlock; ++i) sum[i] += w[i];
  for (int k = 0; k < 3; ++k) {
    sum += stride_;
    float c[kBlock];
    std::copy_n(rgb[k], kBlock, c);
    for (size_t i = 0; i < kBlock; ++i) sum[i] += w[i] * c[i];
  }
  if (!exposure) return;
  for (const Eigen::Array3f* terms : {&exposure->inverse, &exposure->shift}) {
    for (int k = 0; k < 3; ++k) {
      sum += stride_;
      const float term = (*terms)[k];
      for (size_t i = 0; i < kBlock; ++i) sum[i] += w[i] * term;
    }
  }
}

Eigen::Vector3f ColorSums::Mean(size_t texel, float share_of_exposures) const {
  const float weight = Weight(texel);
  const Eigen::Array3f mean = Three(1, texel) / weight;
  if (!(share_of_exposures > 0)) return mean.matrix();
  const Eigen::Array3f as_seen =
      (mean * Three(4, texel) - Three(7, texel)) / weight;
  return (mean + share_of_exposures * (as_seen - mean)).matrix();
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
      lumas.emplace_back(Luma(sample.rgb), sample.weight);
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
      if (std::abs(Luma(sample.rgb) - median) <= limit) continue;
      sample.weight = 0;
      dropped += i < owned;
    }
  }
  return dropped;
}

}  // namespace facet
