// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// From the colours that several keyframes show of a texel to one (method,
// Sec. 8.6). Internal to TextureBaker.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "texture/keyframe_images.h"

namespace facet {

// One image lookup and what it counts.
struct ColorSample {
  Eigen::Vector3f rgb = Eigen::Vector3f::Zero();  // 0-255
  float weight = 0;                               // 0 = not there
};

// Sharpness of every keyframe relative to the median one; all 1 if power is 0.
std::vector<float> Sharpness(const KeyframeImages& images, double power);

// Sums over the samples of one texel.
struct ColorSum {
  Eigen::Array3f rgb = Eigen::Array3f::Zero();  // w C
  float weight = 0;                             // w
  // Of C -> (C - offset) / gain, the way back to the exposures of the samples:
  // w / gain and w offset / gain, offset in 0-255.
  Eigen::Array3f inverse = Eigen::Array3f::Zero();
  Eigen::Array3f shift = Eigen::Array3f::Zero();

  void Add(const Eigen::Vector3f& color, float w) {
    rgb += w * color.array();
    weight += w;
  }

  // Of the exposure of the sample that was added.
  void AddExposure(const Eigen::Array3f& inverse_gain,
                   const Eigen::Array3f& offset_over_gain,
                   float w) {
    inverse += w * inverse_gain;
    shift += w * offset_over_gain;
  }

  // The mean, taken the given share of the way from the common exposure back to
  // those of its samples: to their weighted mean of (C - offset) / gain.
  // weight > 0.
  Eigen::Vector3f Mean(float share_of_exposures) const {
    const Eigen::Array3f mean = rgb / weight;
    if (!(share_of_exposures > 0)) return mean.matrix();
    const Eigen::Array3f as_seen = (mean * inverse - shift) / weight;
    return (mean + share_of_exposures * (as_seen - mean)).matrix();
  }
};

// Sample i of view v of n texels is samples[n v + i]. Sets the weight of samples
// to 0 whose luma (0-1) is farther than `limit` from
// the weighted median of their texel. Returns how many of the first `owned`
// texels these were.
size_t DropOutliers(size_t n,
                    size_t owned,
                    size_t num_views,
                    float limit,
                    std::vector<ColorSample>* samples);

}  // namespace facet
