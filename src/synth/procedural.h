// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Aperiodic functions of the plane that the painted surfaces are made of. Pure
// functions of position and seed, the same on every platform up to the rounding
// of float arithmetic.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>

namespace facet {

inline uint32_t HashCell(int x, int y, uint32_t seed) {
  uint32_t h = seed * 0x9e3779b1u ^ static_cast<uint32_t>(x) * 0x85ebca6bu ^
               static_cast<uint32_t>(y) * 0xc2b2ae35u;
  h ^= h >> 15;
  h *= 0x2c1b3c6du;
  h ^= h >> 12;
  h *= 0x297a2d39u;
  return h ^ (h >> 15);
}

// In [0, 1).
inline float Unit(uint32_t hash) {
  return static_cast<float>(hash >> 8) * 0x1.0p-24f;
}
inline float CellValue(int x, int y, uint32_t seed) {
  return Unit(HashCell(x, y, seed));
}

inline int Floor(float x) {
  const int i = static_cast<int>(x);
  return i - (x < static_cast<float>(i));
}

// Smooth noise of feature size 1, values in [-1, 1].
inline float ValueNoise(float x, float y, uint32_t seed) {
  const int ix = Floor(x), iy = Floor(y);
  const float a = x - ix, b = y - iy;
  const float sa = a * a * (3 - 2 * a), sb = b * b * (3 - 2 * b);
  const float v00 = CellValue(ix, iy, seed), v10 = CellValue(ix + 1, iy, seed);
  const float v01 = CellValue(ix, iy + 1, seed);
  const float v11 = CellValue(ix + 1, iy + 1, seed);
  const float top = v00 + sa * (v10 - v00), bottom = v01 + sa * (v11 - v01);
  return 2 * (top + sb * (bottom - top)) - 1;
}

// Octaves of ValueNoise, each half the size and half the height of the one
// before; within [-2, 2].
inline float FractalNoise(float x, float y, uint32_t seed, int octaves) {
  float sum = 0, height = 1;
  for (int i = 0; i < octaves; ++i) {
    sum += height * ValueNoise(x, y, seed + i);
    // Turned lattices hide each other's axes.
    const float turned = 1.6f * x + 1.2f * y;
    y = 1.6f * y - 1.2f * x;
    x = turned;
    height *= 0.5f;
  }
  return sum;
}

// The nearest of one random point a unit cell.
struct NearestSeed {
  float distance = 8;    // to the nearest point
  float gap = 8;         // distance to the second nearest minus `distance`
  float dx = 0, dy = 0;  // from the nearest point to the query
  uint32_t hash = 0;     // of the nearest point
};

inline NearestSeed FindNearestSeed(float x, float y, uint32_t seed) {
  NearestSeed best;
  float second = 8;
  const int ix = Floor(x), iy = Floor(y);
  for (int j = iy - 1; j <= iy + 1; ++j) {
    for (int i = ix - 1; i <= ix + 1; ++i) {
      const uint32_t h = HashCell(i, j, seed);
      const float dx = x - i - Unit(h);
      const float dy = y - j - Unit(h * 0x9e3779b1u + 0x7f4a7c15u);
      const float d = std::sqrt(dx * dx + dy * dy);
      if (d < best.distance) {
        second = best.distance;
        best.distance = d;
        best.dx = dx;
        best.dy = dy;
        best.hash = h;
      } else if (d < second) {
        second = d;
      }
    }
  }
  best.gap = second - best.distance;
  return best;
}

// 0 below `from`, 1 above `to`, smooth between; from > to reverses.
inline float SmoothStep(float from, float to, float x) {
  float t = (x - from) / (to - from);
  t = t < 0 ? 0 : t > 1 ? 1 : t;
  return t * t * (3 - 2 * t);
}

inline Eigen::Vector3f Mix(const Eigen::Vector3f& a,
                           const Eigen::Vector3f& b,
                           float t) {
  return a + t * (b - a);
}

// Hue in turns, saturation and value in [0, 1].
Eigen::Vector3f HsvColor(float hue, float saturation, float value);

// Ink of a line of made-up letters, in [0, 1]: letters of height 1 and width
// 0.62 on lines of pitch 1.6, y downwards; words and line ends are irregular.
// Lines end at `line_length`; outside [0, lines) there is none.
float LetterInk(float x, float y, float line_length, int lines, uint32_t seed);

}  // namespace facet
