// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "render/depth_raster.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace facet {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kNear = 1e-3;  // [m]

// A triangle before the camera, cut at kNear: at most four corners.
struct Polygon {
  std::array<Vector3d, 4> corners;
  int size = 0;

  void Add(const Vector3d& y) { corners[size++] = y; }
};

Polygon ClipNear(const std::array<Vector3d, 3>& triangle) {
  Polygon polygon;
  for (int i = 0; i < 3; ++i) {
    const Vector3d &a = triangle[i], &b = triangle[(i + 1) % 3];
    const bool a_in = a.z() >= kNear, b_in = b.z() >= kNear;
    if (a_in) polygon.Add(a);
    if (a_in == b_in) continue;
    // From the near to the far side in both triangles of the edge: the same
    // numbers, hence no gap.
    const Vector3d &inside = a_in ? a : b, &outside = a_in ? b : a;
    const double t = (inside.z() - kNear) / (inside.z() - outside.z());
    Vector3d cut = inside + t * (outside - inside);
    cut.z() = kNear;
    polygon.Add(cut);
  }
  return polygon;
}

// 1 / z of a plane is linear in the pixel: value(u, v) = u du + v dv + at_0.
struct InverseDepth {
  double du = 0, dv = 0, at_0 = 0;
  float low = 0, high = 0;  // of the corners

  // False for a plane through the camera, which is seen as a line.
  bool Set(const std::array<Vector3d, 3>& y,
           const Polygon& polygon,
           const Pinhole& camera) {
    const Vector3d normal = (y[1] - y[0]).cross(y[2] - y[0]);
    const double d = normal.dot(y[0]);
    if (!(std::abs(d) > 1e-12 * normal.norm())) return false;
    du = normal.x() / (camera.fx * d);
    dv = normal.y() / (camera.fy * d);
    at_0 = normal.z() / d - camera.cx * du - camera.cy * dv;
    double nearest = polygon.corners[0].z(), farthest = nearest;
    for (int i = 1; i < polygon.size; ++i) {
      nearest = std::min(nearest, polygon.corners[i].z());
      farthest = std::max(farthest, polygon.corners[i].z());
    }
    low = static_cast<float>(1 / farthest);
    high = static_cast<float>(1 / nearest);
    return true;
  }
};

// The pixels of `row` between the sides of a convex polygon, as [first, last].
std::pair<int, int> SpanOf(const std::array<Vector2d, 4>& u,
                           int size,
                           int row,
                           int width) {
  double left = 1e30, right = -1e30;
  for (int i = 0; i < size; ++i) {
    const Vector2d *a = &u[i], *b = &u[(i + 1) % size];
    // One order for both triangles of an edge.
    if (b->y() < a->y() || (b->y() == a->y() && b->x() < a->x())) {
      std::swap(a, b);
    }
    if (row < a->y() || row > b->y()) continue;
    const double height = b->y() - a->y();
    const double x = height > 0
                         ? a->x() + (row - a->y()) / height * (b->x() - a->x())
                         : a->x();
    left = std::min(left, x);
    right = std::max(right, height > 0 ? x : b->x());
  }
  return {static_cast<int>(std::ceil(std::clamp(left, 0.0, 1.0 * width))),
          static_cast<int>(std::floor(std::clamp(right, -1.0, width - 1.0)))};
}

void Fill(const Polygon& polygon,
          const InverseDepth& inverse_z,
          const Pinhole& camera,
          std::vector<float>* buffer) {
  std::array<Vector2d, 4> u;
  double top = 1e30, bottom = -1e30;
  for (int i = 0; i < polygon.size; ++i) {
    u[i] = camera.Project<double>(polygon.corners[i]);
    top = std::min(top, u[i].y());
    bottom = std::max(bottom, u[i].y());
  }
  const int first =
      static_cast<int>(std::ceil(std::clamp(top, 0.0, 1.0 * camera.height)));
  const int last = static_cast<int>(
      std::floor(std::clamp(bottom, -1.0, camera.height - 1.0)));
  const float du = static_cast<float>(inverse_z.du);
  const float low = inverse_z.low, high = inverse_z.high;
  for (int row = first; row <= last; ++row) {
    const auto [begin, end] = SpanOf(u, polygon.size, row, camera.width);
    float* pixel = buffer->data() + static_cast<size_t>(row) * camera.width;
    const float at_begin = static_cast<float>(
        inverse_z.at_0 + row * inverse_z.dv + begin * inverse_z.du);
    for (int column = begin; column <= end; ++column) {
      float value = at_begin + static_cast<float>(column - begin) * du;
      value = value < low ? low : value;
      value = value > high ? high : value;
      pixel[column] = pixel[column] > value ? pixel[column] : value;
    }
  }
}

}  // namespace

std::vector<float> RasterizeDepth(const RayScene& scene,
                                  const Pinhole& camera,
                                  const Pose& cam_from_world) {
  std::vector<Vector3d> y(scene.vertices().size());
  const Eigen::Matrix3d rotation = cam_from_world.RotationMatrix();
  for (size_t i = 0; i < y.size(); ++i) {
    y[i] = rotation * scene.vertices()[i] + cam_from_world.translation;
  }
  std::vector<float> buffer(static_cast<size_t>(camera.width) * camera.height,
                            0.0f);
  InverseDepth inverse_z;
  for (const std::array<int, 3>& face : scene.faces()) {
    const std::array<Vector3d, 3> triangle = {
        y[face[0]], y[face[1]], y[face[2]]};
    const Polygon polygon = ClipNear(triangle);
    if (polygon.size < 3 || !inverse_z.Set(triangle, polygon, camera)) continue;
    Fill(polygon, inverse_z, camera, &buffer);
  }
  for (float& z : buffer) z = z > 0 ? 1 / z : 0.0f;
  return buffer;
}

}  // namespace facet
