// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "synth/baked_texture.h"

#include <algorithm>
#include <cmath>

#include "util/parallel_for.h"

namespace facet {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double kPi = 3.14159265358979;

// Patches that give light, as points with a facing direction.
struct Lights {
  struct Sample {
    Vector3d position, facing;
    double power;  // times cos cos / (pi r^2) gives the irradiance
    Vector3f color;
  };
  std::vector<Sample> samples;
};

Lights PlaceLights(const SynthRoom& room) {
  Lights lights;
  constexpr int kLamp = 3;
  for (int i = 0; i < kLamp * kLamp; ++i) {
    const double x = ((i % kLamp + 0.5) / kLamp - 0.5) * room.lamp_size;
    const double y = ((i / kLamp + 0.5) / kLamp - 0.5) * room.lamp_size;
    lights.samples.push_back({room.lamp + Vector3d(x, y, 0),
                              Vector3d(0, 0, -1),
                              7.4 / (kLamp * kLamp),
                              Vector3f(1.0f, 0.96f, 0.89f)});
  }
  const Vector3d right = room.window_normal.cross(Vector3d::UnitZ());
  constexpr int kWindow = 2;
  for (int i = 0; i < kWindow * kWindow; ++i) {
    const double x =
        ((i % kWindow + 0.5) / kWindow - 0.5) * room.window_size.x();
    const double z =
        ((i / kWindow + 0.5) / kWindow - 0.5) * room.window_size.y();
    lights.samples.push_back({room.window + x * right + z * Vector3d::UnitZ(),
                              room.window_normal,
                              6.4 / (kWindow * kWindow),
                              Vector3f(0.88f, 0.95f, 1.0f)});
  }
  return lights;
}

// Share of the hemisphere that is open, near occluders counting most.
double Openness(const RayScene& scene, const Vector3d& p, const Vector3d& n) {
  constexpr int kRays = 24;
  constexpr double kReach = 0.6;
  const Vector3d a = n.unitOrthogonal(), b = n.cross(a);
  double open = 0;
  for (int i = 0; i < kRays; ++i) {
    const double r2 = (i + 0.5) / kRays, angle = 2.399963229728653 * i;
    const double r = std::sqrt(r2);
    const Vector3d d = r * std::cos(angle) * a + r * std::sin(angle) * b +
                       std::sqrt(1 - r2) * n;
    const RayHit hit = scene.Intersect(p, d, 0, kReach);
    open += hit.face < 0 ? 1 : hit.t / kReach;
  }
  return open / kRays;
}

Vector3f LightAt(const RayScene& scene,
                 const Lights& lights,
                 const SurfacePoint& point) {
  const Vector3d p = point.position + 2e-3 * point.normal;
  Vector3f sum = Vector3f(0.52f, 0.52f, 0.53f) *
                 static_cast<float>(Openness(scene, p, point.normal));
  for (const auto& light : lights.samples) {
    const Vector3d to_light = light.position - p;
    const double r2 = std::max(to_light.squaredNorm(), 0.25);
    const double cosine = point.normal.dot(to_light) / std::sqrt(r2);
    const double facing = -light.facing.dot(to_light) / std::sqrt(r2);
    if (cosine <= 0 || facing <= 0) continue;
    if (scene.Occluded(p, to_light, 0, 0.99)) continue;
    sum += light.color *
           static_cast<float>(light.power * cosine * facing / (kPi * r2));
  }
  return sum;
}

// Light on a lattice over the chart.
struct LightMap {
  int columns = 0, rows = 0;
  std::vector<Vector3f> values;

  // x, y in [0, 1].
  Vector3f At(float x, float y) const {
    const float fx = std::clamp(x, 0.0f, 1.0f) * (columns - 1);
    const float fy = std::clamp(y, 0.0f, 1.0f) * (rows - 1);
    const int i = std::min(static_cast<int>(fx), columns - 2);
    const int j = std::min(static_cast<int>(fy), rows - 2);
    const float a = fx - i, b = fy - j;
    const Vector3f* v = &values[static_cast<size_t>(j) * columns + i];
    return (1 - b) * ((1 - a) * v[0] + a * v[1]) +
           b * ((1 - a) * v[columns] + a * v[columns + 1]);
  }
};

LightMap BakeLight(const RoomSurface& surface,
                   const RayScene& scene,
                   const Lights& lights,
                   double step) {
  LightMap map;
  map.columns = 3 + static_cast<int>(surface.size.x() / step);
  map.rows = 3 + static_cast<int>(surface.size.y() / step);
  map.values.resize(static_cast<size_t>(map.columns) * map.rows);
  ParallelFor(
      0,
      map.values.size(),
      [&](size_t k) {
        const int i = static_cast<int>(k % map.columns);
        const int j = static_cast<int>(k / map.columns);
        // A little inside, so that no sample lies in the neighbouring surface.
        const double x = std::clamp(double(i) / (map.columns - 1), 0.01, 0.99);
        const double y = std::clamp(double(j) / (map.rows - 1), 0.01, 0.99);
        map.values[k] =
            LightAt(scene,
                    lights,
                    surface.at(x * surface.size.x(), y * surface.size.y()));
      },
      64);
  return map;
}

bool IsShell(const std::string& name) {
  return name == "floor" || name == "ceiling" || name.rfind("wall_", 0) == 0;
}

BakedTexture BakeSurface(const RoomSurface& surface,
                         const RayScene& scene,
                         const Lights& lights,
                         const BakeOptions& options) {
  const double step =
      IsShell(surface.name) ? options.room_step : options.thing_step;
  BakedTexture texture(surface.size, static_cast<float>(step));
  const bool glows = surface.paint.style == PaintStyle::kOutside;
  const LightMap light = BakeLight(surface, scene, lights, options.light_step);
  ParallelFor(
      0,
      texture.height(),
      [&](size_t j) {
        const float v = (j + 0.5f) * texture.step_v();
        for (int i = 0; i < texture.width(); ++i) {
          const float u = (i + 0.5f) * texture.step_u();
          Vector3f rgb = EvaluatePaint(surface.paint, u, v, surface.size);
          if (!glows) {
            rgb = rgb.cwiseProduct(
                light.At(u / surface.size.x(), v / surface.size.y()));
          }
          texture.Set(i, static_cast<int>(j), rgb);
        }
      },
      8);
  texture.BuildLevels();
  return texture;
}

}  // namespace

BakedTexture::BakedTexture(const Eigen::Vector2f& size, float step)
    : levels_(1) {
  Level& level = levels_[0];
  level.width = std::max(2, static_cast<int>(std::ceil(size.x() / step)));
  level.height = std::max(2, static_cast<int>(std::ceil(size.y() / step)));
  level.rgb.resize(3 * static_cast<size_t>(level.width) * level.height);
  step_u_ = size.x() / level.width;
  step_v_ = size.y() / level.height;
}

void BakedTexture::Set(int i, int j, const Vector3f& rgb) {
  uint8_t* out = &levels_[0].rgb[3 * (static_cast<size_t>(j) * width() + i)];
  for (int c = 0; c < 3; ++c) {
    // Compresses the brightest tenth like film instead of clipping it.
    const float x = rgb[c];
    const float y = x < 0.8f ? x : 1 - 0.2f * std::exp(-(x - 0.8f) / 0.2f);
    out[c] = static_cast<uint8_t>(std::clamp(y, 0.0f, 1.0f) * 255 + 0.5f);
  }
}

void BakedTexture::BuildLevels() {
  while (levels_.back().width > 2 && levels_.back().height > 2) {
    const Level& fine = levels_.back();
    Level coarse;
    coarse.width = (fine.width + 1) / 2;
    coarse.height = (fine.height + 1) / 2;
    coarse.rgb.resize(3 * static_cast<size_t>(coarse.width) * coarse.height);
    for (int j = 0; j < coarse.height; ++j) {
      const int j0 = 2 * j, j1 = std::min(2 * j + 1, fine.height - 1);
      for (int i = 0; i < coarse.width; ++i) {
        const int i0 = 2 * i, i1 = std::min(2 * i + 1, fine.width - 1);
        const auto at = [&](int x, int y) {
          return &fine.rgb[3 * (static_cast<size_t>(y) * fine.width + x)];
        };
        const uint8_t *a = at(i0, j0), *b = at(i1, j0), *c = at(i0, j1),
                      *d = at(i1, j1);
        uint8_t* out =
            &coarse.rgb[3 * (static_cast<size_t>(j) * coarse.width + i)];
        for (int k = 0; k < 3; ++k) {
          out[k] = static_cast<uint8_t>((a[k] + b[k] + c[k] + d[k] + 2) / 4);
        }
      }
    }
    levels_.push_back(std::move(coarse));
  }
}

Vector3f BakedTexture::SampleLevel(const Level& level, float x, float y) const {
  x = std::clamp(x, 0.0f, level.width - 1.0f);
  y = std::clamp(y, 0.0f, level.height - 1.0f);
  const int i = std::min(static_cast<int>(x), level.width - 2);
  const int j = std::min(static_cast<int>(y), level.height - 2);
  const float a = x - i, b = y - j;
  const uint8_t* p = &level.rgb[3 * (static_cast<size_t>(j) * level.width + i)];
  const uint8_t* q = p + 3 * static_cast<size_t>(level.width);
  Vector3f rgb;
  for (int c = 0; c < 3; ++c) {
    const float top = p[c] + a * (p[c + 3] - p[c]);
    const float bottom = q[c] + a * (q[c + 3] - q[c]);
    rgb[c] = top + b * (bottom - top);
  }
  return rgb;
}

Vector3f BakedTexture::Sample(float u, float v, float footprint) const {
  const float step = std::min(step_u_, step_v_);
  const float lod = std::clamp(std::log2(std::max(footprint / step, 1e-6f)),
                               0.0f,
                               static_cast<float>(levels_.size() - 1));
  const int fine = std::min(static_cast<int>(lod),
                            std::max(0, static_cast<int>(levels_.size()) - 2));
  const float x = u / step_u_, y = v / step_v_;
  const auto sample = [&](int k) {
    const float scale = 1.0f / static_cast<float>(1 << k);
    return SampleLevel(levels_[k], x * scale - 0.5f, y * scale - 0.5f);
  };
  const float blend = lod - fine;
  const Vector3f near = sample(fine);
  if (blend < 1e-3f || fine + 1 >= static_cast<int>(levels_.size())) {
    return near;
  }
  return near + blend * (sample(fine + 1) - near);
}

std::vector<BakedTexture> BakeRoom(const SynthRoom& room,
                                   const RayScene& scene,
                                   const BakeOptions& options) {
  const Lights lights = PlaceLights(room);
  std::vector<BakedTexture> textures(room.surfaces.size());
  ParallelFor(0, textures.size(), [&](size_t i) {
    textures[i] = BakeSurface(room.surfaces[i], scene, lights, options);
  });
  return textures;
}

}  // namespace facet
