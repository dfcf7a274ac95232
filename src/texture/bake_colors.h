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
  Eigen::Array4f color = Eigen::Array4f::Zero();  // (rgb, 1), 0-255
  float weight = 0;                               // 0 = not there
};

// Sharpness of every keyframe relative to the median one; all 1 if power is 0.
std::vector<float> Sharpness(const KeyframeImages& images, double power);

// The exposure of a keyframe in the form of ColorSum: (red, green, blue, 1).
struct ExposureLanes {
  explicit ExposureLanes(const Exposure& exposure) {
    gain << exposure.gain, 1;
    offset << 255.0f * exposure.offset, 0;
    inverse << exposure.gain.inverse(), 0;
    shift = offset * inverse;
  }

  Eigen::Array4f gain, offset;    // C' = gain C + offset, 0-255
  Eigen::Array4f inverse, shift;  // C = inverse C' - shift
};

// Sums over the samples of one texel.
struct ColorSum {
  // (w C', w)
  Eigen::Array4f color = Eigen::Array4f::Zero();
  // Of the way back to the exposures of the samples: w inverse, w shift.
  Eigen::Array4f inverse = Eigen::Array4f::Zero();
  Eigen::Array4f shift = Eigen::Array4f::Zero();

  float weight() const { return color[3]; }

  void Add(const Eigen::Array4f& corrected, float w) { color += w * corrected; }
  void AddExposure(const ExposureLanes& exposure, float w) {
    inverse += w * exposure.inverse;
    shift += w * exposure.shift;
  }

  // The mean, taken the given share of the way from the common exposure back to
  // those of its samples: to their weighted mean of C. weight() > 0.
  Eigen::Vector3f Mean(float share_of_exposures) const {
    const Eigen::Array4f mean = color / color[3];
    if (!(share_of_exposures > 0)) return mean.head<3>().matrix();
    const Eigen::Array4f as_seen = (mean * inverse - shift) / color[3];
    return (mean + share_of_exposures * (as_seen - mean)).head<3>().matrix();
  }
};

// Sample i of view v of n texels is samples[n v + i]. Sets the weight of
// samples to 0 whose luma (0-1) is farther than `limit` from the weighted
// median of their texel. Returns how many of the first `owned` texels these
// were.
size_t DropOutliers(size_t n,
                    size_t owned,
                    size_t num_views,
                    float limit,
                    std::vector<ColorSample>* samples);

}  // namespace facet
