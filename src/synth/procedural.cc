// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "synth/procedural.h"

#include <algorithm>

namespace facet {
namespace {

float DistanceToSegment(
    float px, float py, float ax, float ay, float bx, float by) {
  const float dx = bx - ax, dy = by - ay;
  const float length2 = dx * dx + dy * dy;
  float t = length2 > 0 ? ((px - ax) * dx + (py - ay) * dy) / length2 : 0;
  t = std::clamp(t, 0.0f, 1.0f);
  const float ex = px - ax - t * dx, ey = py - ay - t * dy;
  return std::sqrt(ex * ex + ey * ey);
}

}  // namespace

Eigen::Vector3f HsvColor(float hue, float saturation, float value) {
  const auto channel = [&](float n) {
    const float k = std::fmod(n + 6 * (hue - std::floor(hue)), 6.0f);
    const float part = std::clamp(std::min(k, 4 - k), 0.0f, 1.0f);
    return value * (1 - saturation * part);
  };
  return {channel(5), channel(3), channel(1)};
}

float LetterInk(float x, float y, float line_length, int lines, uint32_t seed) {
  constexpr float kWidth = 0.62f, kPitch = 1.6f, kStroke = 0.085f;
  const int line = Floor(y / kPitch);
  const float below = y - line * kPitch;
  if (line < 0 || line >= lines || below > 1 || x < 0) return 0;
  const bool last = line == lines - 1;
  const float end =
      line_length * (last ? 0.55f : 1 - 0.12f * CellValue(line, 7, seed));
  const int column = Floor(x / kWidth);
  if ((column + 1) * kWidth > end) return 0;
  const uint32_t letter = HashCell(column, line, seed);
  if (Unit(letter) < 0.17f) return 0;  // a blank between words
  // Three strokes between the nodes of a 3 x 3 grid make a letter.
  const float lx = x / kWidth - column, ly = below;
  float nearest = 1;
  uint32_t bits = letter * 0x85ebca6bu;
  int from = (bits >> 4) % 9;
  for (int stroke = 0; stroke < 3; ++stroke) {
    const int to = (from + 1 + (bits >> (9 + 4 * stroke)) % 8) % 9;
    const auto node_x = [](int k) { return 0.16f + 0.30f * (k % 3); };
    const auto node_y = [](int k) { return 0.10f + 0.40f * (k / 3); };
    nearest = std::min(nearest,
                       DistanceToSegment(lx * kWidth,
                                         ly,
                                         node_x(from) * kWidth,
                                         node_y(from),
                                         node_x(to) * kWidth,
                                         node_y(to)));
    from = to;
  }
  return SmoothStep(1.5f * kStroke, 0.7f * kStroke, nearest);
}

}  // namespace facet
