// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Bilinear intensity lookup with its own exact gradient: within a pixel cell
// the interpolant is a polynomial, so value and gradient belong together
// (the gradient jumps at cell borders).
#pragma once

#include <algorithm>

#include "geometry/image_view.h"

namespace facet {

struct Sample {
  double value = 0;
  double dx = 0, dy = 0;  // per px
  bool clamped = false;   // u was outside and moved to the border
};

// I(u, v) with grad I. Outside the pixel centres' rectangle the point is
// clamped to the border and flagged; the derivative across that border is then
// 0, which is the exact derivative of the clamped function.
inline Sample SampleBilinear(const ImageView<float>& image, double u, double v) {
  Sample s;
  const double max_u = image.width - 1.0, max_v = image.height - 1.0;
  const bool u_inside = u >= 0 && u <= max_u, v_inside = v >= 0 && v <= max_v;
  s.clamped = !(u_inside && v_inside);
  u = std::min(std::max(0.0, u), max_u);  // this order turns NaN into 0
  v = std::min(std::max(0.0, v), max_v);
  const int x = std::min(static_cast<int>(u), image.width - 2);
  const int y = std::min(static_cast<int>(v), image.height - 2);
  const double a = u - x, b = v - y;
  const float* row0 = image.data + y * image.stride + x;
  const float* row1 = row0 + image.stride;
  const double top = row0[0] + a * (row0[1] - row0[0]);
  const double bottom = row1[0] + a * (row1[1] - row1[0]);
  s.value = top + b * (bottom - top);
  if (u_inside) s.dx = (1 - b) * (row0[1] - row0[0]) + b * (row1[1] - row1[0]);
  if (v_inside) s.dy = bottom - top;
  return s;
}

}  // namespace facet
