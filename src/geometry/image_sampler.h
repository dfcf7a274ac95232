// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Intensity lookup between pixels, with gradient (method, Sec. 7.3). Bilinear
// and bicubic come with their own exact gradient: within a pixel cell they are
// polynomials (the bilinear gradient jumps at cell borders, the bicubic one is
// continuous).
#pragma once

#include <algorithm>
#include <vector>

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
inline Sample SampleBilinear(const ImageView<float>& image,
                             double u,
                             double v) {
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

// Weights of the four taps at -1, 0, 1, 2 for the position a in [0, 1] of the
// Catmull-Rom spline, and their derivatives.
struct CatmullRom {
  double w[4], d[4];
  explicit CatmullRom(double a)
      : w{a * (-0.5 + a * (1 - 0.5 * a)),
          1 + a * a * (-2.5 + 1.5 * a),
          a * (0.5 + a * (2 - 1.5 * a)),
          a * a * (-0.5 + 0.5 * a)},
        d{-0.5 + a * (2 - 1.5 * a),
          a * (-5 + 4.5 * a),
          0.5 + a * (4 - 4.5 * a),
          a * (-1 + 1.5 * a)} {}
};

// As SampleBilinear, bicubic. Taps beyond the border repeat it.
inline Sample SampleBicubic(const ImageView<float>& image, double u, double v) {
  Sample s;
  const double max_u = image.width - 1.0, max_v = image.height - 1.0;
  const bool u_inside = u >= 0 && u <= max_u, v_inside = v >= 0 && v <= max_v;
  s.clamped = !(u_inside && v_inside);
  u = std::min(std::max(0.0, u), max_u);
  v = std::min(std::max(0.0, v), max_v);
  const int x = std::min(static_cast<int>(u), image.width - 2);
  const int y = std::min(static_cast<int>(v), image.height - 2);
  const CatmullRom cx(u - x), cy(v - y);
  for (int j = 0; j < 4; ++j) {
    const int row = std::clamp(y - 1 + j, 0, image.height - 1);
    double value = 0, dx = 0;
    for (int i = 0; i < 4; ++i) {
      const double tap =
          image.At(std::clamp(x - 1 + i, 0, image.width - 1), row);
      value += cx.w[i] * tap;
      dx += cx.d[i] * tap;
    }
    s.value += cy.w[j] * value;
    s.dx += cy.w[j] * dx;
    s.dy += cy.d[j] * value;
  }
  if (!u_inside) s.dx = 0;
  if (!v_inside) s.dy = 0;
  return s;
}

// Gradient images by the Scharr kernel (3, 10, 3) x (-1, 0, 1) / 32: exact on
// ramps. The border is repeated. Both have the size and stride of `image`.
inline void ScharrGradients(const ImageView<float>& image,
                            std::vector<float>* dx,
                            std::vector<float>* dy) {
  const size_t size = static_cast<size_t>(image.stride * image.height);
  dx->assign(size, 0.0f);
  dy->assign(size, 0.0f);
  for (int y = 0; y < image.height; ++y) {
    float* const dx_row = dx->data() + y * image.stride;
    float* const dy_row = dy->data() + y * image.stride;
    const int up = std::max(y - 1, 0), down = std::min(y + 1, image.height - 1);
    for (int x = 0; x < image.width; ++x) {
      const int l = std::max(x - 1, 0), r = std::min(x + 1, image.width - 1);
      dx_row[x] = (3 * (image.At(r, up) - image.At(l, up)) +
                   10 * (image.At(r, y) - image.At(l, y)) +
                   3 * (image.At(r, down) - image.At(l, down))) /
                  32;
      dy_row[x] = (3 * (image.At(l, down) - image.At(l, up)) +
                   10 * (image.At(x, down) - image.At(x, up)) +
                   3 * (image.At(r, down) - image.At(r, up))) /
                  32;
    }
  }
}

// An image with all that `sampling` reads.
struct SampledImage {
  SampledImage(const ImageView<float>& view) : image(view) {}  // NOLINT
  ImageView<float> image;
  Sampling sampling = Sampling::kBilinear;
  ImageView<float> gradient_x, gradient_y;  // of ScharrGradients
};

inline Sample SampleAt(const SampledImage& image, double u, double v) {
  if (image.sampling == Sampling::kBicubic) {
    return SampleBicubic(image.image, u, v);
  }
  Sample s = SampleBilinear(image.image, u, v);
  if (image.sampling == Sampling::kScharr) {
    if (u >= 0 && u <= image.image.width - 1) {
      s.dx = SampleBilinear(image.gradient_x, u, v).value;
    }
    if (v >= 0 && v <= image.image.height - 1) {
      s.dy = SampleBilinear(image.gradient_y, u, v).value;
    }
  }
  return s;
}

}  // namespace facet
