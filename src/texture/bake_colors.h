// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// From the colours that several keyframes show of a texel to one (method,
// Sec. 8.6). Internal to TextureBaker.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "texture/keyframe_images.h"

namespace facet {

// One image lookup and what it counts.
struct ColorSample {
  Eigen::Array3f rgb = Eigen::Array3f::Zero();  // 0-255, at the common exposure
  float weight = 0;                             // 0 = not there
};

// Sharpness of every keyframe relative to the median one; all 1 if power is 0.
std::vector<float> Sharpness(const KeyframeImages& images, double power);

// The exposure of a keyframe, for colours of 0 to 255.
struct ByteExposure {
  explicit ByteExposure(const Exposure& exposure)
      : gain(exposure.gain),
        offset(255.0f * exposure.offset),
        inverse(gain.inverse()),
        shift(offset * inverse) {}

  Eigen::Array3f gain, offset;    // C' = gain C + offset
  Eigen::Array3f inverse, shift;  // C = inverse C' - shift
};

// Sums over the samples of the texels of a tile, in rows of memory: the loops
// over a row are the compiler's to vectorise.
class ColorSums {
 public:
  // Texels are added in blocks of so many.
  static constexpr size_t kBlock = 16;

  explicit ColorSums(size_t num_blocks)
      : stride_(kBlock * num_blocks), rows_(kRows * stride_, 0.0f) {}

  // Adds samples of the texels of one block, `rgb` in three rows of kBlock at
  // the common exposure, and of the way back to the exposure they were taken
  // at, which may be null.
  void Add(size_t block,
           const float* const rgb[3],
           const float* weight,
           const ByteExposure* exposure);

  float Weight(size_t texel) const { return rows_[texel]; }

  // The mean, taken the given share of the way from the common exposure back to
  // those of its samples: to their weighted mean of C. Weight() > 0.
  Eigen::Vector3f Mean(size_t texel, float share_of_exposures) const;

 private:
  // w; w C'; w inverse; w shift.
  static constexpr size_t kRows = 10;

  Eigen::Array3f Three(size_t row, size_t texel) const {
    const float* at = rows_.data() + row * stride_ + texel;
    return {at[0], at[stride_], at[2 * stride_]};
  }

  size_t stride_;
  std::vector<float> rows_;
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
