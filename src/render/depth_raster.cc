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

// A polygon in the image, ready to be filled.
class Outline {
 public:
  Outline(const std::array<Vector2d, 4>& u, int size) : size_(size) {
    for (int i = 0; i < size; ++i) {
      const Vector2d *a = &u[i], *b = &u[(i + 1) % size];
      // One order for both triangles of an edge: the same numbers.
      if (b->y() < a->y() || (b->y() == a->y() && b->x() < a->x())) {
        std::swap(a, b);
      }
      const double height = b->y() - a->y();
      sides_[i] = {a->x(),
                   a->y(),
                   b->y(),
                   height > 0 ? (b->x() - a->x()) / height : b->x() - a->x(),
                   !(height > 0)};
      top_ = std::min(top_, a->y());
      bottom_ = std::max(bottom_, b->y());
    }
  }

  double top() const { return top_; }
  double bottom() const { return bottom_; }

  // The pixels of a row between the sides, as [first, last].
  std::pair<int, int> Span(int row, int width) const {
    double left = 1e30, right = -1e30;
    for (int i = 0; i < size_; ++i) {
      const Side& side = sides_[i];
      if (row < side.top || row > side.bottom) continue;
      const double x =
          side.flat ? side.x : side.x + (row - side.top) * side.slope;
      left = std::min(left, x);
      right = std::max(right, side.flat ? side.x + side.slope : x);
    }
    return {static_cast<int>(std::ceil(std::clamp(left, 0.0, 1.0 * width))),
            static_cast<int>(std::floor(std::clamp(right, -1.0, width - 1.0)))};
  }

 private:
  // From the upper end; of a flat one `slope` is the length.
  struct Side {
    double x, top, bottom, slope;
    bool flat;
  };
  std::array<Side, 4> sides_;
  int size_;
  double top_ = 1e30, bottom_ = -1e30;
};

void Fill(const Outline& outline,
          const InverseDepth& inverse_z,
          const Pinhole& camera,
          std::vector<float>* buffer) {
  const int first = static_cast<int>(
      std::ceil(std::clamp(outline.top(), 0.0, 1.0 * camera.height)));
  const int last = static_cast<int>(
      std::floor(std::clamp(outline.bottom(), -1.0, camera.height - 1.0)));
  const float du = static_cast<float>(inverse_z.du);
  const float low = inverse_z.low, high = inverse_z.high;
  for (int row = first; row <= last; ++row) {
    const auto [begin, end] = outline.Span(row, camera.width);
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

// A vertex before the camera: its pixel, and the sides of the image beyond
// which it lies, as bits.
struct Seen {
  Vector2d u;
  unsigned beyond = 0;
};

Seen LookAt(const Vector3d& y, const Pinhole& camera) {
  Seen seen;
  seen.u = camera.Project<double>(y);
  seen.beyond = (seen.u.x() < 0) | (seen.u.x() > camera.width - 1) << 1 |
                (seen.u.y() < 0) << 2 | (seen.u.y() > camera.height - 1) << 3;
  return seen;
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
  std::vector<Seen> seen(y.size());
  for (size_t i = 0; i < y.size(); ++i) {
    if (y[i].z() >= kNear) seen[i] = LookAt(y[i], camera);
  }
  InverseDepth inverse_z;
  for (const std::array<int, 3>& face : scene.faces()) {
    const std::array<Vector3d, 3> triangle = {
        y[face[0]], y[face[1]], y[face[2]]};
    const int num_before = (triangle[0].z() >= kNear) +
                           (triangle[1].z() >= kNear) +
                           (triangle[2].z() >= kNear);
    const bool whole = num_before == 3;
    if (num_before == 0 ||
        (whole && (seen[face[0]].beyond & seen[face[1]].beyond &
                   seen[face[2]].beyond))) {
      continue;
    }
    const Polygon polygon =
        whole ? Polygon{{triangle[0], triangle[1], triangle[2]}, 3}
              : ClipNear(triangle);
    if (polygon.size < 3 || !inverse_z.Set(triangle, polygon, camera)) continue;
    std::array<Vector2d, 4> u;
    for (int i = 0; i < polygon.size; ++i) {
      u[i] =
          whole ? seen[face[i]].u : camera.Project<double>(polygon.corners[i]);
    }
    Fill(Outline(u, polygon.size), inverse_z, camera, &buffer);
  }
  for (float& z : buffer) z = z > 0 ? 1 / z : 0.0f;
  return buffer;
}

}  // namespace facet
