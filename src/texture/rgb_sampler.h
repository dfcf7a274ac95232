// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Colours between the pixels of an 8-bit image, 0-255. The point must lie
// within the rectangle of the pixel centres.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <opencv2/core.hpp>

namespace facet {

inline Eigen::Vector3f RgbAt(const cv::Mat& rgb, int x, int y) {
  const uint8_t* p = rgb.ptr<uint8_t>(y) + 3 * x;
  return {static_cast<float>(p[0]),
          static_cast<float>(p[1]),
          static_cast<float>(p[2])};
}

inline Eigen::Vector3f BilinearRgb(const cv::Mat& rgb, float u, float v) {
  const int x = std::min(static_cast<int>(u), rgb.cols - 2);
  const int y = std::min(static_cast<int>(v), rgb.rows - 2);
  const float a = u - static_cast<float>(x), b = v - static_cast<float>(y);
  const uint8_t* r0 = rgb.ptr<uint8_t>(y) + 3 * x;
  const uint8_t* r1 = r0 + rgb.step[0];
  const float w00 = (1 - a) * (1 - b), w10 = a * (1 - b), w01 = (1 - a) * b,
              w11 = a * b;
  Eigen::Vector3f color;
  for (int k = 0; k < 3; ++k) {
    color[k] = w00 * r0[k] + w10 * r0[k + 3] + w01 * r1[k] + w11 * r1[k + 3];
  }
  return color;
}

// Of the four neighbours at -1, 0, 1, 2.
inline void CatmullRomWeights(float t, float* w) {
  w[0] = t * (-0.5f + t * (1 - 0.5f * t));
  w[1] = 1 + t * t * (-2.5f + 1.5f * t);
  w[2] = t * (0.5f + t * (2 - 1.5f * t));
  w[3] = t * t * (-0.5f + 0.5f * t);
}

// Catmull-Rom; beyond the image the border repeats. May overshoot 0-255.
inline Eigen::Vector3f BicubicRgb(const cv::Mat& rgb, float u, float v) {
  const int x = static_cast<int>(u), y = static_cast<int>(v);
  float wx[4], wy[4];
  CatmullRomWeights(u - static_cast<float>(x), wx);
  CatmullRomWeights(v - static_cast<float>(y), wy);
  Eigen::Vector3f color = Eigen::Vector3f::Zero();
  for (int j = 0; j < 4; ++j) {
    const int row = std::clamp(y + j - 1, 0, rgb.rows - 1);
    for (int i = 0; i < 4; ++i) {
      const int col = std::clamp(x + i - 1, 0, rgb.cols - 1);
      color += wy[j] * wx[i] * RgbAt(rgb, col, row);
    }
  }
  return color;
}

}  // namespace facet
