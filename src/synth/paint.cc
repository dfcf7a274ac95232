// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "synth/paint.h"

#include <algorithm>

#include "synth/paint_things.h"
#include "synth/procedural.h"

namespace facet {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

Vector3f Plaster(const Paint& p, float u, float v) {
  const float slow = FractalNoise(u / 0.6f, v / 0.6f, p.seed, 2);
  const float grain = FractalNoise(u / 0.012f, v / 0.012f, p.seed + 9, 2);
  return p.base * (1 + 0.025f * slow + 0.018f * grain);
}

Vector3f Wallpaper(const Paint& p, float u, float v) {
  const float fibre = ValueNoise(u / 0.004f, v / 0.011f, p.seed + 1);
  const float cloud = FractalNoise(u / 0.05f, v / 0.05f, p.seed + 2, 3);
  Vector3f color = p.base * (1 + 0.05f * fibre + 0.05f * cloud);
  // Leaves in two sizes, each with its own angle and tone.
  for (int layer = 0; layer < 2; ++layer) {
    const float cell = layer ? 0.045f : 0.11f;
    const NearestSeed leaf =
        FindNearestSeed(u / cell, v / cell, p.seed + 20 + layer);
    const float angle = 6.2832f * Unit(leaf.hash * 0x9e3779b1u);
    const float a = std::cos(angle) * leaf.dx + std::sin(angle) * leaf.dy;
    const float b = std::cos(angle) * leaf.dy - std::sin(angle) * leaf.dx;
    const float width = 0.05f + 0.11f * Unit(leaf.hash * 77u);
    const float edge = (a * a) / 0.16f + (b * b) / (width * width);
    const float inside = SmoothStep(1.1f, 0.9f, edge);
    const float vein = SmoothStep(0.022f, 0.010f, std::abs(b));
    const float tone = 0.75f + 0.5f * Unit(leaf.hash * 1013u);
    color = Mix(color, p.accent * tone, 0.8f * inside);
    color = Mix(color, p.base, 0.6f * inside * vein);
  }
  return color;
}

// Grain along u; `tone` shifts the board as a whole.
Vector3f Grain(const Paint& p, float u, float v, uint32_t seed, float tone) {
  const float bend = FractalNoise(u / 0.35f, v / 0.07f, seed, 3);
  const float rings = std::sin(6.2832f * (v / 0.016f + 1.6f * bend));
  const float streak = ValueNoise(u / 0.09f, v / 0.0028f, seed + 5);
  const float pores = ValueNoise(u / 0.014f, v / 0.0022f, seed + 6);
  Vector3f color = Mix(p.base, p.accent, 0.35f + 0.25f * rings + 0.3f * tone);
  color *= 1 + 0.10f * streak;
  color *= 1 - 0.35f * SmoothStep(0.55f, 0.85f, pores);
  const NearestSeed knot = FindNearestSeed(u / 0.5f, v / 0.16f, seed + 8);
  if (Unit(knot.hash * 31u) < 0.4f) {
    const float r = std::hypot(knot.dx * 0.5f, knot.dy * 0.16f);
    const float ring = 0.5f + 0.5f * std::sin(r / 0.0018f);
    color *= 1 - SmoothStep(0.022f, 0.006f, r) * (0.35f + 0.3f * ring);
  }
  return color;
}

Vector3f Planks(const Paint& p, float u, float v) {
  constexpr float kWidth = 0.115f, kLength = 1.1f;
  const int row = Floor(v / kWidth);
  const float shifted = u / kLength + CellValue(row, 3, p.seed);
  const int board = Floor(shifted);
  const uint32_t hash = HashCell(board, row, p.seed);
  const float edge_v = std::min(v - row * kWidth, (row + 1) * kWidth - v);
  const float edge_u = kLength * std::min(shifted - board, board + 1 - shifted);
  const float gap = SmoothStep(0.0008f, 0.0028f, std::min(edge_u, edge_v));
  const Vector3f color =
      Grain(p, u, v, p.seed + hash % 100000u, 2 * Unit(hash) - 1);
  return color * (0.35f + 0.65f * gap);
}

// Grooves around a grid of panels.
float PanelGrooves(float u,
                   float v,
                   const Vector2f& size,
                   int columns,
                   int rows,
                   float margin) {
  const float w = size.x() / columns, h = size.y() / rows;
  const float x = u - std::floor(u / w) * w, y = v - std::floor(v / h) * h;
  const float inset = std::min(std::min(x, w - x), std::min(y, h - y));
  return SmoothStep(0.006f, 0.002f, std::abs(inset - margin));
}

Vector3f Door(const Paint& p, float u, float v, const Vector2f& size) {
  const float groove = PanelGrooves(u, v, size, 2, 3, 0.08f);
  const float brush = ValueNoise(u / 0.005f, v / 0.12f, p.seed);
  const float dirt = FractalNoise(u / 0.15f, v / 0.15f, p.seed + 4, 3);
  Vector3f color = p.base * (1 + 0.03f * brush + 0.02f * dirt);
  color *= 1 - 0.45f * groove;
  const Vector2f knob(u - 0.07f, v - 0.48f * size.y());
  const float metal = SmoothStep(0.03f, 0.026f, knob.norm());
  return Mix(
      color, Vector3f(0.75f, 0.7f, 0.5f) * (0.7f + 10 * knob.y()), metal);
}

Vector3f Drawers(const Paint& p, float u, float v, const Vector2f& size) {
  const int columns = std::max(1, static_cast<int>(size.x() / 0.45f));
  const int rows = std::max(1, static_cast<int>(size.y() / 0.2f));
  const float w = size.x() / columns, h = size.y() / rows;
  const float x = u - Floor(u / w) * w, y = v - Floor(v / h) * h;
  Vector3f color = Grain(p, u, v, p.seed + Floor(u / w) + 7 * Floor(v / h), 0);
  color *= 1 - 0.6f * PanelGrooves(u, v, size, columns, rows, 0.008f);
  const float knob = std::hypot(x - 0.5f * w, y - 0.5f * h);
  return Mix(color,
             Vector3f(0.85f, 0.8f, 0.7f) * (1.1f - knob / 0.03f),
             SmoothStep(0.018f, 0.015f, knob));
}

Vector3f Carpet(const Paint& p, float u, float v, const Vector2f& size) {
  const float wobble = 0.006f * FractalNoise(u / 0.05f, v / 0.05f, p.seed, 2);
  const float inset =
      std::min(std::min(u, size.x() - u), std::min(v, size.y() - v)) + wobble;
  const int band = Floor(inset / 0.07f);
  const int motif = static_cast<int>(
      FindNearestSeed(u / 0.13f, v / 0.09f, p.seed + 3).hash % 5u);
  const float pick = inset < 0.28f ? CellValue(band, 0, p.seed + 1)
                                   : CellValue(motif, 1, p.seed + 2);
  Vector3f color = Mix(p.base, p.accent, pick);
  if (motif == 3 && inset > 0.28f) color = Vector3f(0.85f, 0.8f, 0.68f);
  const NearestSeed tuft = FindNearestSeed(u / 0.006f, v / 0.006f, p.seed + 5);
  color *= 0.72f + 0.4f * Unit(tuft.hash) + 0.15f * (0.5f - tuft.distance);
  return color * (1 + 0.08f * FractalNoise(u / 0.2f, v / 0.2f, p.seed, 2));
}

Vector3f Fabric(const Paint& p, float u, float v) {
  const float warp = ValueNoise(u / 0.0035f, v / 0.03f, p.seed + 1);
  const float weft = ValueNoise(u / 0.03f, v / 0.0035f, p.seed + 2);
  const float melange = FractalNoise(u / 0.02f, v / 0.02f, p.seed + 3, 2);
  const float stripe =
      SmoothStep(0.25f, 0.35f, ValueNoise(u / 0.035f, 0.5f, p.seed + 4));
  Vector3f color = Mix(p.base, p.accent, 0.75f * stripe);
  return color * (1 + 0.13f * warp + 0.13f * weft + 0.10f * melange);
}

Vector3f Terrazzo(const Paint& p, float u, float v) {
  Vector3f color =
      p.base * (1 + 0.05f * FractalNoise(u / 0.006f, v / 0.006f, p.seed, 2));
  for (int layer = 0; layer < 2; ++layer) {
    const float cell = layer ? 0.011f : 0.032f;
    const NearestSeed chip =
        FindNearestSeed(u / cell, v / cell, p.seed + 3 + layer);
    const float inside = SmoothStep(0.10f, 0.18f, chip.gap) *
                         (Unit(chip.hash * 5u) < 0.55f ? 1 : 0);
    const Vector3f tone =
        Mix(p.accent, Vector3f(0.9f, 0.86f, 0.8f), Unit(chip.hash * 91u)) *
        (0.55f + 0.6f * Unit(chip.hash * 17u));
    color = Mix(color, tone, 0.85f * inside);
  }
  return color;
}

Vector3f Marble(const Paint& p, float u, float v) {
  const float warp = FractalNoise(u / 0.09f, v / 0.09f, p.seed, 4);
  const float vein =
      std::abs(FractalNoise(u / 0.04f + warp, v / 0.07f, p.seed + 7, 4));
  const float grain = ValueNoise(u / 0.003f, v / 0.003f, p.seed + 8);
  return Mix(p.accent, p.base, SmoothStep(0.0f, 0.28f, vein)) *
         (1 + 0.06f * grain + 0.06f * warp);
}

Vector3f Patches(const Paint& p, float u, float v) {
  const NearestSeed patch = FindNearestSeed(u / 0.055f, v / 0.055f, p.seed);
  const NearestSeed dot = FindNearestSeed(u / 0.012f, v / 0.012f, p.seed + 2);
  Vector3f color = HsvColor(Unit(patch.hash), 0.65f, 0.8f);
  color *= 0.8f + 0.35f * Unit(dot.hash);
  return color * (0.3f + 0.7f * SmoothStep(0.04f, 0.10f, patch.gap));
}

Vector3f EvaluateStyle(const Paint& p, float u, float v, const Vector2f& size) {
  switch (p.style) {
    case PaintStyle::kPlaster:
      return Plaster(p, u, v);
    case PaintStyle::kWallpaper:
      return Wallpaper(p, u, v);
    case PaintStyle::kPlanks:
      return Planks(p, u, v);
    case PaintStyle::kWood:
      return size.x() >= size.y() ? Grain(p, u, v, p.seed, 0)
                                  : Grain(p, v, u, p.seed, 0);
    case PaintStyle::kDoor:
      return Door(p, u, v, size);
    case PaintStyle::kDrawers:
      return Drawers(p, u, v, size);
    case PaintStyle::kCarpet:
      return Carpet(p, u, v, size);
    case PaintStyle::kFabric:
      return Fabric(p, u, v);
    case PaintStyle::kTerrazzo:
      return Terrazzo(p, u, v);
    case PaintStyle::kMarble:
      return Marble(p, u, v);
    case PaintStyle::kPatches:
      return Patches(p, u, v);
    case PaintStyle::kPoster:
      return PaintPoster(p, u, v, size);
    case PaintStyle::kPrint:
      return PaintPrint(p, u, v, size);
    case PaintStyle::kCover:
      return PaintCover(p, u, v, size);
    case PaintStyle::kCardboard:
      return PaintCardboard(p, u, v, size);
    case PaintStyle::kOutside:
      return PaintOutside(p, u, v, size);
  }
  return p.base;
}

}  // namespace

Vector3f EvaluatePaint(const Paint& paint,
                       float u,
                       float v,
                       const Vector2f& size) {
  for (size_t i = paint.decals.size(); i-- > 0;) {
    const Decal& d = paint.decals[i];
    const float c = std::cos(d.angle), s = std::sin(d.angle);
    const float dx = u - d.center.x(), dy = v - d.center.y();
    const float x = c * dx + s * dy + 0.5f * d.size.x();
    const float y = c * dy - s * dx + 0.5f * d.size.y();
    if (x >= 0 && y >= 0 && x <= d.size.x() && y <= d.size.y()) {
      return EvaluatePaint(*d.paint, x, y, d.size);
    }
  }
  return EvaluateStyle(paint, u, v, size).cwiseMax(0.02f).cwiseMin(0.98f);
}

}  // namespace facet
