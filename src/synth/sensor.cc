// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "synth/sensor.h"

#include <algorithm>
#include <cmath>

#include "util/random.h"

namespace facet {
namespace {

constexpr double kHalfPi = 1.5707963267948966;

uint64_t PixelSeed(uint64_t seed, size_t i) {
  return SplitMix64(seed ^ (0x9e3779b97f4a7c15ULL * (i + 1)));
}

// Sum of four bytes of `bits`, scaled to mean 0 and variance 1: close enough to
// normal for sensor noise and quick.
float CheapNormal(uint32_t bits) {
  const int sum = static_cast<int>((bits & 255) + (bits >> 8 & 255) +
                                   (bits >> 16 & 255) + (bits >> 24 & 255));
  return (static_cast<float>(sum) - 510) / 147.8f;
}

// White noise averaged over 3 x 3 px and scaled back to variance 1.
std::vector<float> CorrelatedNoise(int width, int height, uint64_t seed) {
  const size_t size = static_cast<size_t>(width) * height;
  std::vector<float> white(size), rows(size), noise(size);
  for (size_t i = 0; i < size; ++i) {
    white[i] = CheapNormal(static_cast<uint32_t>(PixelSeed(seed, i)));
  }
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const size_t row = static_cast<size_t>(y) * width;
      rows[row + x] = white[row + std::max(0, x - 1)] + white[row + x] +
                      white[row + std::min(width - 1, x + 1)];
    }
  }
  for (int y = 0; y < height; ++y) {
    const size_t up = static_cast<size_t>(std::max(0, y - 1)) * width;
    const size_t here = static_cast<size_t>(y) * width;
    const size_t down =
        static_cast<size_t>(std::min(height - 1, y + 1)) * width;
    for (int x = 0; x < width; ++x) {
      noise[here + x] = (rows[up + x] + rows[here + x] + rows[down + x]) / 3;
    }
  }
  return noise;
}

// Pixels whose surface the projector, to the right of the camera, does not
// reach: going left, their place in the projector's image falls behind that of
// a pixel further right.
std::vector<uint8_t> ProjectorShadow(const Pinhole& camera,
                                     const std::vector<float>& depth,
                                     double baseline) {
  std::vector<uint8_t> shadow(depth.size(), 0);
  for (int y = 0; y < camera.height; ++y) {
    double leftmost = 1e30;
    for (int x = camera.width - 1; x >= 0; --x) {
      const size_t i = static_cast<size_t>(y) * camera.width + x;
      if (depth[i] <= 0) continue;
      const double place = x - camera.fx * baseline / depth[i];
      if (place > leftmost + 0.5) {
        shadow[i] = 1;
      } else {
        leftmost = std::min(leftmost, place);
      }
    }
  }
  return shadow;
}

}  // namespace

std::vector<uint16_t> SenseDepth(const Pinhole& camera,
                                 const std::vector<float>& exact,
                                 const std::vector<float>& angle,
                                 double shift,
                                 uint64_t seed,
                                 const DepthSensorOptions& options) {
  const int width = camera.width, height = camera.height;
  const std::vector<float> axial =
      CorrelatedNoise(width, height, SplitMix64(seed));
  const std::vector<uint8_t> shadow =
      ProjectorShadow(camera, exact, options.projector_baseline_m);
  // Disparities are as fine as those of the real sensor at its focal length,
  // whatever the size of this image.
  const double disparity_scale =
      585 * options.projector_baseline_m / options.disparity_step_px;
  std::vector<uint16_t> raw(exact.size(), 0);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const size_t i = static_cast<size_t>(y) * width + x;
      const uint64_t bits = PixelSeed(seed + 1, i);
      const float jitter_x = 0.8f * CheapNormal(static_cast<uint32_t>(bits));
      const float jitter_y = 0.8f * CheapNormal(bits >> 32);
      const int sx =
          std::clamp(x + static_cast<int>(std::lround(jitter_x)), 0, width - 1);
      const int sy = std::clamp(
          y + static_cast<int>(std::lround(jitter_y)), 0, height - 1);
      const size_t source = static_cast<size_t>(sy) * width + sx;
      // Lateral jitter frays edges; on the same surface it would only add axial
      // noise that the model above already contains.
      const double here = exact[i];
      const bool other_surface =
          std::abs(exact[source] - here) > 0.03 * here + 0.01;
      double z = other_surface ? exact[source] : here;
      const double theta = angle[other_surface ? source : i];
      if (z <= 0 || shadow[i] || theta > 80 * kHalfPi / 90) continue;
      if (other_surface) {
        const double dice = (PixelSeed(seed + 2, i) >> 11) * 0x1.0p-53;
        if (dice < 0.35) continue;
        if (dice < 0.5) z = here + (z - here) * (dice - 0.35) / 0.15;
      }
      const double total = 0.0012 + 0.0019 * (z - 0.4) * (z - 0.4) +
                           0.0001 / std::sqrt(z) * theta * theta /
                               ((kHalfPi - theta) * (kHalfPi - theta));
      // The measured noise contains that of the quantisation to come.
      const double quantum = z * z / disparity_scale;
      const double sigma =
          std::sqrt(std::max(total * total - quantum * quantum / 12, 1e-8));
      z += sigma * axial[i];
      if (z < options.min_depth_m || z > options.max_depth_m) continue;
      z = disparity_scale / std::round(disparity_scale / z);
      raw[i] =
          static_cast<uint16_t>(std::clamp(std::lround(z * shift), 0L, 65534L));
    }
  }
  return raw;
}

std::vector<uint8_t> SenseColor(int width,
                                int height,
                                const std::vector<float>& exact,
                                uint64_t seed,
                                const ColorSensorOptions& options) {
  std::vector<uint8_t> rgb(exact.size());
  const double cx = 0.5 * (width - 1), cy = 0.5 * (height - 1);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const size_t i = static_cast<size_t>(y) * width + x;
      const double r2 =
          ((x - cx) * (x - cx) + (y - cy) * (y - cy)) / (cx * cx + cy * cy);
      const float gain =
          static_cast<float>(options.gain * (1 - options.vignetting * r2));
      const uint64_t a = PixelSeed(seed, i), b = SplitMix64(a);
      const uint32_t bits[3] = {static_cast<uint32_t>(a),
                                static_cast<uint32_t>(a >> 32),
                                static_cast<uint32_t>(b)};
      for (int c = 0; c < 3; ++c) {
        const float noise =
            static_cast<float>(options.noise_grey) * CheapNormal(bits[c]);
        rgb[3 * i + c] = static_cast<uint8_t>(
            std::clamp(gain * exact[3 * i + c] + noise + 0.5f, 0.0f, 255.0f));
      }
    }
  }
  return rgb;
}

}  // namespace facet
