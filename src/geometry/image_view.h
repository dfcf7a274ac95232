// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// A borrowed single-channel image: how pictures cross layers without OpenCV.
#pragma once

#include <cstddef>

namespace facet {

// How intensities are read between pixels, and what counts as their gradient.
enum class Sampling {
  kBilinear,  // bilinear, its own piecewise derivative
  kScharr,    // bilinear, gradient = interpolated Scharr / 32 images: not its
              // derivative, but smoother (method, Sec. 7.3)
  kBicubic,   // Catmull-Rom, its own derivative: C1
};

template <typename T>
struct ImageView {
  const T* data = nullptr;  // row-major, not owned
  int width = 0;            // [px]
  int height = 0;           // [px]
  ptrdiff_t stride = 0;     // elements between rows

  const T& At(int x, int y) const { return data[y * stride + x]; }
};

}  // namespace facet
