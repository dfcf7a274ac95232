// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Which texel centres lie in a triangle of a texture page (method, Sec. 4.3).
//
// Corners are rounded to 1/4096 px and the edge functions evaluated in
// integers, so ownership is exact: two triangles that share an edge never claim
// the same centre and leave none out (a centre on an edge belongs to one side
// by the direction of the edge).
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace facet {

// Corners in px; the texel in column j and row i has its centre at
// (j + 0.5, i + 0.5). Either orientation.
using UvTriangle = std::array<Eigen::Vector2d, 3>;

// Calls visit(column, row) for every owned centre in [0, width) x [0, height),
// row by row. Triangles without area own nothing. |coordinates| < 1e5 px.
template <typename Visit>
void RasterizeTriangle(const UvTriangle& uv,
                       int width,
                       int height,
                       const Visit& visit) {
  constexpr int64_t kOne = 4096;
  int64_t x[3], y[3];
  for (int k = 0; k < 3; ++k) {
    x[k] = std::llround(uv[k].x() * kOne);
    y[k] = std::llround(uv[k].y() * kOne);
  }
  const int64_t area =
      (x[1] - x[0]) * (y[2] - y[0]) - (y[1] - y[0]) * (x[2] - x[0]);
  if (area == 0) return;
  if (area < 0) {
    std::swap(x[1], x[2]);
    std::swap(y[1], y[2]);
  }
  // First and last centre within the bounding box: (c + 1/2) kOne >= low.
  const auto first = [](int64_t low) {
    return static_cast<int>(
        std::ceil((static_cast<double>(low) - kOne / 2) / kOne));
  };
  const auto last = [](int64_t high) {
    return static_cast<int>(
        std::floor((static_cast<double>(high) - kOne / 2) / kOne));
  };
  const int col0 = std::max(0, first(std::min({x[0], x[1], x[2]})));
  const int col1 = std::min(width - 1, last(std::max({x[0], x[1], x[2]})));
  const int row0 = std::max(0, first(std::min({y[0], y[1], y[2]})));
  const int row1 = std::min(height - 1, last(std::max({y[0], y[1], y[2]})));
  int64_t dx[3], dy[3], bias[3];
  for (int k = 0; k < 3; ++k) {
    const int l = (k + 1) % 3;
    dx[k] = x[l] - x[k];
    dy[k] = y[l] - y[k];
    // An edge owns its own points in exactly one of its two directions.
    bias[k] = dy[k] > 0 || (dy[k] == 0 && dx[k] < 0) ? 0 : -1;
  }
  for (int row = row0; row <= row1; ++row) {
    const int64_t py = row * kOne + kOne / 2;
    for (int col = col0; col <= col1; ++col) {
      const int64_t px = col * kOne + kOne / 2;
      bool inside = true;
      for (int k = 0; k < 3 && inside; ++k) {
        inside = dx[k] * (py - y[k]) - dy[k] * (px - x[k]) + bias[k] >= 0;
      }
      if (inside) visit(col, row);
    }
  }
}

// (b1, b2) of a point: point = (1 - b1 - b2) uv0 + b1 uv1 + b2 uv2, clamped to
// the triangle (rounding may put an owned centre a hair outside).
inline Eigen::Vector2d UvBarycentrics(const UvTriangle& uv,
                                      const Eigen::Vector2d& point) {
  const Eigen::Vector2d a = uv[1] - uv[0], b = uv[2] - uv[0];
  const Eigen::Vector2d p = point - uv[0];
  const double det = a.x() * b.y() - a.y() * b.x();
  if (std::abs(det) < 1e-12) return {1.0 / 3, 1.0 / 3};
  const double b1 = std::max(0.0, (p.x() * b.y() - p.y() * b.x()) / det);
  const double b2 = std::max(0.0, (a.x() * p.y() - a.y() * p.x()) / det);
  const double excess = std::max(1.0, b1 + b2);
  return {b1 / excess, b2 / excess};
}

}  // namespace facet
