// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "synth/paint_things.h"

#include <algorithm>
#include <cmath>

#include "synth/procedural.h"

namespace facet {

using Eigen::Vector2f;
using Eigen::Vector3f;

namespace {

// A made-up picture filling [0, 1]^2 (x right, y up): horizon, sun, hills or
// loose shapes; scale [m per unit] sets the brush strokes.
Vector3f PictureMotif(const Paint& p, float x, float y, float scale) {
  const auto tone = [&](int k) {
    return HsvColor(CellValue(k, 1, p.seed),
                    0.25f + 0.5f * CellValue(k, 2, p.seed),
                    0.35f + 0.6f * CellValue(k, 3, p.seed));
  };
  const float m = scale;
  Vector3f color = Mix(tone(0), tone(1), y);
  if (p.seed % 2 == 0) {  // a landscape
    const float sun = std::hypot(x - CellValue(0, 5, p.seed),
                                 y - 0.6f - 0.3f * CellValue(1, 5, p.seed));
    color =
        Mix(color, Vector3f(0.95f, 0.9f, 0.75f), SmoothStep(0.12f, 0.10f, sun));
    for (int k = 0; k < 4; ++k) {
      const float ridge =
          0.66f - 0.17f * k +
          0.13f * FractalNoise(x * (2.0f + k), 0.5f, p.seed + 31 * k, 5);
      const float trees = 0.02f * ValueNoise(x * m / 0.006f, 1.5f, p.seed + k);
      color = Mix(
          color, tone(2 + k), SmoothStep(0.0f, 0.004f / m, ridge + trees - y));
    }
  } else {  // loose shapes
    for (int k = 0; k < 14; ++k) {
      const float cx = CellValue(k, 11, p.seed), cy = CellValue(k, 12, p.seed);
      const float angle = 6.28f * CellValue(k, 13, p.seed);
      const float a = std::cos(angle) * (x - cx) + std::sin(angle) * (y - cy);
      const float b = std::cos(angle) * (y - cy) - std::sin(angle) * (x - cx);
      const float w = 0.05f + 0.2f * CellValue(k, 14, p.seed);
      const float h = 0.03f + 0.16f * CellValue(k, 15, p.seed);
      const float d = k % 3 ? std::max(std::abs(a) / w, std::abs(b) / h)
                            : std::hypot(a / w, b / h);
      color = Mix(color, tone(20 + k), 0.9f * SmoothStep(1.02f, 0.99f, d));
    }
  }
  const float stroke =
      ValueNoise(x * m / 0.016f +
                     2 * ValueNoise(x * m / 0.04f, y * m / 0.04f, p.seed + 51),
                 y * m / 0.004f,
                 p.seed + 50);
  const float blot = FractalNoise(x * m / 0.03f, y * m / 0.03f, p.seed + 52, 3);
  return color * (1 + 0.12f * stroke + 0.12f * blot);
}

}  // namespace

Vector3f PaintPoster(const Paint& p, float u, float v, const Vector2f& size) {
  const float margin = 0.06f * size.minCoeff();
  const float caption = 0.16f * size.y();
  const Vector3f paper(0.93f, 0.91f, 0.86f);
  const float left = margin, right = size.x() - margin;
  const float bottom = caption, top = size.y() - margin;
  if (u > left && u < right && v > bottom && v < top) {
    const float w = right - left, h = top - bottom;
    return PictureMotif(p, (u - left) / w, (v - bottom) / h, std::max(w, h));
  }
  // A title and two lines of small print below the picture.
  const float letter = 0.36f * caption;
  const float y = bottom - 0.12f * caption - v;
  float ink = LetterInk(
      (u - left) / letter, y / letter, (right - left) / letter, 1, p.seed + 60);
  const float small = 0.12f * caption;
  ink = std::max(ink,
                 LetterInk((u - left) / small,
                           (y - 1.4f * letter) / small,
                           (right - left) / small,
                           2,
                           p.seed + 61));
  return Mix(paper, Vector3f(0.12f, 0.12f, 0.15f), ink) *
         (1 + 0.02f * ValueNoise(u / 0.004f, v / 0.004f, p.seed));
}

Vector3f PaintPrint(const Paint& p, float u, float v, const Vector2f& size) {
  const float margin = 0.08f * size.x();
  const float x = u - margin, y = size.y() - margin - v;  // y downwards
  const float width = size.x() - 2 * margin;
  const Vector3f paper =
      p.base * (1 + 0.015f * ValueNoise(u / 0.003f, v / 0.003f, p.seed));
  const float title = 0.085f * size.x();
  float ink = LetterInk(x / title, y / title, width / title, 1, p.seed);
  const float picture_top = 1.6f * title, picture_height = 0.42f * width;
  const float py = y - picture_top;
  if (x > 0 && x < width && py > 0 && py < picture_height) {
    return PictureMotif(p, x / width, 1 - py / picture_height, width);
  }
  const float text_y = py - picture_height - 0.5f * title;
  const float letter = 0.0042f;
  const float room =
      size.y() - 2 * margin - picture_top - picture_height - 0.5f * title;
  const int lines = std::max(0, static_cast<int>(room / (1.6f * letter)));
  const float column = 0.47f * width;
  for (int c = 0; c < 2; ++c) {
    ink = std::max(ink,
                   LetterInk((x - c * 0.53f * width) / letter,
                             text_y / letter,
                             column / letter,
                             lines,
                             p.seed + 5 + c));
  }
  return Mix(paper, p.accent, ink);
}

Vector3f PaintCover(const Paint& p, float u, float v, const Vector2f& size) {
  // Spines are read along their longer side.
  const bool turned = size.y() > 2.5f * size.x();
  const float along = turned ? size.y() - v : u;
  const float across = turned ? size.x() - u : size.y() - v;
  const Vector2f s = turned ? Vector2f(size.y(), size.x()) : size;
  const float worn = FractalNoise(u / 0.02f, v / 0.02f, p.seed, 3);
  Vector3f color = p.base * (1 + 0.09f * worn);
  const int band = Floor(along / (0.11f * s.x()));
  if (CellValue(band, 1, p.seed) < 0.22f) color = p.accent * (1 + 0.06f * worn);
  const float title = std::min(0.45f * s.y(), 0.10f * s.x() + 0.004f);
  const float x = (along - 0.14f * s.x()) / title;
  const float y = (across - 0.5f * (s.y() - (turned ? 1 : 3) * title)) / title;
  float ink =
      LetterInk(x, y, 0.75f * s.x() / title, turned ? 1 : 2, p.seed + 3);
  const float small = 0.4f * title;
  ink = std::max(ink,
                 LetterInk((along - 0.14f * s.x()) / small,
                           (across - 0.86f * s.y()) / small,
                           0.6f * s.x() / small,
                           1,
                           p.seed + 4));
  const bool dark = p.base.sum() < 1.4f;
  const Vector3f ink_color =
      dark ? Vector3f(0.92f, 0.86f, 0.62f) : Vector3f(0.15f, 0.1f, 0.12f);
  return Mix(color, ink_color, ink);
}

Vector3f PaintCardboard(const Paint& p,
                        float u,
                        float v,
                        const Vector2f& size) {
  const float ribs = ValueNoise(u / 0.0045f, v / 0.09f, p.seed);
  const float stain = FractalNoise(u / 0.04f, v / 0.04f, p.seed + 1, 4);
  Vector3f color = p.base * (1 + 0.05f * ribs + 0.06f * stain);
  const float tape = std::abs(
      v - (0.5f + 0.1f * CellValue(1, 1, p.seed)) * size.y() - 0.004f * ribs);
  color = Mix(color,
              p.accent * (1 + 0.05f * stain),
              0.7f * SmoothStep(0.027f, 0.025f, tape));
  const Vector2f corner(0.12f * size.x(), 0.42f * size.y());
  const float w = 0.5f * size.x(), h = 0.32f * size.y();
  const float x = u - corner.x(), y = corner.y() - v;
  if (x > 0 && x < w && y > 0 && y < h) color = Vector3f(0.9f, 0.89f, 0.85f);
  const float letter = 0.2f * h;
  const float ink = x < w && y < h ? LetterInk((x - 0.05f * w) / letter,
                                               (y - 0.1f * h) / letter,
                                               0.9f * w / letter,
                                               3,
                                               p.seed + 2)
                                   : 0;
  return Mix(color, Vector3f(0.1f, 0.1f, 0.12f), ink);
}

Vector3f PaintOutside(const Paint& p, float u, float v, const Vector2f& size) {
  const float x = u / size.x(), y = v / size.y();
  const float cloud = FractalNoise(u / 0.25f, v / 0.12f, p.seed, 5);
  Vector3f color =
      Mix(Vector3f(0.78f, 0.87f, 0.95f), Vector3f(0.45f, 0.65f, 0.92f), y);
  color =
      Mix(color, Vector3f(0.97f, 0.97f, 0.97f), SmoothStep(0.0f, 0.7f, cloud));
  const int house = Floor(u / 0.12f);
  const float roof = 0.3f + 0.22f * CellValue(house, 0, p.seed);
  if (y < roof) {
    color = HsvColor(0.05f + 0.1f * CellValue(house, 1, p.seed),
                     0.3f,
                     0.45f + 0.3f * CellValue(house, 2, p.seed));
    const float wx = u / 0.02f - Floor(u / 0.02f);
    const float wy = v / 0.028f - Floor(v / 0.028f);
    const float lit = CellValue(Floor(u / 0.02f), Floor(v / 0.028f), p.seed);
    if (wx > 0.3f && wx < 0.75f && wy > 0.3f) color *= 0.35f + 0.9f * lit;
  }
  const float hedge = 0.14f + 0.05f * FractalNoise(u / 0.06f, 0.2f, p.seed, 4);
  if (y < hedge) {
    color = Vector3f(0.25f, 0.42f, 0.18f) *
            (1 + 0.4f * FractalNoise(u / 0.012f, v / 0.012f, p.seed, 3));
  }
  const float bar =
      std::min(std::abs(x - 0.5f) * size.x(), std::abs(y - 0.62f) * size.y());
  return bar < 0.022f ? Vector3f(0.85f, 0.84f, 0.8f) : color;
}

}  // namespace facet
