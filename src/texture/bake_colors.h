// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// From the colours that several keyframes show of a texel to one (method,
// Sec. 8.6). Internal to BakeTexture.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "texture/keyframe_images.h"

namespace facet {

// One image lookup and what it counts.
struct ColorSample {
  Eigen::Vector3f rgb = Eigen::Vector3f::Zero();  // 0-255
  float weight = 0;                               // under e = 1; 0 = not there
};

// Sharpness of every keyframe relative to the median one; all 1 if power is 0.
std::vector<float> Sharpness(const KeyframeImages& images, double power);

// The mean of each of n texels, weights to the power given. Sample i of view v
// is samples[n v + i]. Weight 0: no sample.
std::vector<ColorSample> WeightedMean(const std::vector<ColorSample>& samples,
                                      size_t n,
                                      size_t num_views,
                                      float power);

// Takes each mean the given share of the way from the common exposure back to
// those of its samples: to their weighted mean of (C - offset) / gain.
// `exposures` are those of the views.
void UndoExposures(const std::vector<ColorSample>& samples,
                   const std::vector<Exposure>& exposures,
                   float share,
                   std::vector<ColorSample>* means);

// Sets the weight of samples to 0 whose luma (0-1) is farther than `limit` from
// the weighted median of their texel. Returns how many of the first `owned`
// texels these were.
size_t DropOutliers(size_t n,
                    size_t owned,
                    size_t num_views,
                    float limit,
                    std::vector<ColorSample>* samples);

}  // namespace facet
