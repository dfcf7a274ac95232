// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "synth/room.h"

namespace facet {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kTwoPi = 6.283185307179586;

}  // namespace

RoomFrame RoomFrame::At(double x, double y, double z, double yaw) const {
  RoomFrame frame;
  frame.origin = (*this)(x, y, z);
  Eigen::Matrix3d turn;
  turn << std::cos(yaw), -std::sin(yaw), 0, std::sin(yaw), std::cos(yaw), 0, 0,
      0, 1;
  frame.axes = axes * turn;
  return frame;
}

void RoomBuilder::AddQuad(int surface,
                          const Vector2d& low,
                          const Vector2d& high) {
  const Vector2d corners[4] = {
      low, {high.x(), low.y()}, high, {low.x(), high.y()}};
  TriMesh& mesh = room_->mesh;
  const int first = static_cast<int>(mesh.NumVertices());
  for (const Vector2d& c : corners) {
    mesh.vertices.push_back(room_->surfaces[surface].at(c.x(), c.y()).position);
  }
  for (int half = 0; half < 2; ++half) {
    const int k[3] = {0, 1 + half, 2 + half};
    mesh.faces.push_back({first + k[0], first + k[1], first + k[2]});
    room_->face_uv.push_back({corners[k[0]].cast<float>(),
                              corners[k[1]].cast<float>(),
                              corners[k[2]].cast<float>()});
    room_->face_surface.push_back(surface);
    room_->face_plane.push_back(surface);
  }
}

int RoomBuilder::AddRectangle(const std::string& name,
                              const Paint& paint,
                              const Vector3d& o,
                              const Vector3d& a,
                              const Vector3d& b,
                              const Eigen::Vector4d& hole) {
  const int id = static_cast<int>(room_->surfaces.size());
  const double w = a.norm(), h = b.norm();
  const Vector3d ua = a / w, ub = b / h, normal = ua.cross(ub).normalized();
  RoomSurface surface;
  surface.name = name;
  surface.paint = paint;
  surface.size = {static_cast<float>(w), static_cast<float>(h)};
  surface.plane.normal = normal;
  surface.plane.offset = -normal.dot(o);
  surface.at = [o, ua, ub, normal](double u, double v) {
    return SurfacePoint{o + u * ua + v * ub, normal};
  };
  room_->surfaces.push_back(surface);
  const double a0 = hole[0], b0 = hole[1], a1 = hole[2], b1 = hole[3];
  if (a1 <= a0 || b1 <= b0) {
    AddQuad(id, {0, 0}, {w, h});
    return id;
  }
  const double us[4] = {0, a0, a1, w}, vs[4] = {0, b0, b1, h};
  for (int j = 0; j < 3; ++j) {
    for (int i = 0; i < 3; ++i) {
      const bool inside = i == 1 && j == 1;
      if (!inside && us[i + 1] > us[i] && vs[j + 1] > vs[j]) {
        AddQuad(id, {us[i], vs[j]}, {us[i + 1], vs[j + 1]});
      }
    }
  }
  return id;
}

void RoomBuilder::AddBox(const std::string& name,
                         const RoomFrame& frame,
                         const Vector3d& size,
                         const std::function<Paint(BoxSide)>& paint_of,
                         int sides) {
  const double x = 0.5 * size.x(), y = 0.5 * size.y(), z = size.z();
  const Vector3d ex = frame.axes.col(0) * size.x();
  const Vector3d ey = frame.axes.col(1) * size.y();
  const Vector3d ez = frame.axes.col(2) * size.z();
  const auto add = [&](BoxSide side,
                       const char* suffix,
                       const Vector3d& o,
                       const Vector3d& a,
                       const Vector3d& b) {
    if (sides & side) AddRectangle(name + suffix, paint_of(side), o, a, b);
  };
  add(kFront, ".front", frame(-x, -y, 0), ex, ez);
  add(kBack, ".back", frame(x, y, 0), -ex, ez);
  add(kLeft, ".left", frame(-x, y, 0), -ey, ez);
  add(kRight, ".right", frame(x, -y, 0), ey, ez);
  add(kTop, ".top", frame(-x, -y, z), ex, ey);
  add(kBottom, ".bottom", frame(-x, y, 0), ex, -ey);
}

// Triangulates the chart of a curved surface on a regular lattice.
void RoomBuilder::AddChartMesh(RoomSurface surface, int columns, int rows) {
  const int id = static_cast<int>(room_->surfaces.size());
  TriMesh& mesh = room_->mesh;
  const int first = static_cast<int>(mesh.NumVertices());
  const auto uv = [&](int i, int j) {
    return Vector2d(surface.size.x() * double(i) / columns,
                    surface.size.y() * double(j) / rows);
  };
  for (int j = 0; j <= rows; ++j) {
    for (int i = 0; i <= columns; ++i) {
      const Vector2d c = uv(i, j);
      mesh.vertices.push_back(surface.at(c.x(), c.y()).position);
    }
  }
  const auto add = [&](int i0, int j0, int i1, int j1, int i2, int j2) {
    const int n = columns + 1;
    mesh.faces.push_back(
        {first + j0 * n + i0, first + j1 * n + i1, first + j2 * n + i2});
    room_->face_uv.push_back({uv(i0, j0).cast<float>(),
                              uv(i1, j1).cast<float>(),
                              uv(i2, j2).cast<float>()});
    room_->face_surface.push_back(id);
    room_->face_plane.push_back(-1);
  };
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      // The first and last row are fans about a pole.
      if (j > 0) add(i, j, i + 1, j, i + 1, j + 1);
      if (j + 1 < rows) add(i, j, i + 1, j + 1, i, j + 1);
    }
  }
  surface.curved = true;
  room_->surfaces.push_back(std::move(surface));
}

void RoomBuilder::AddRevolution(
    const std::string& name,
    const Paint& paint,
    const RoomFrame& frame,
    const std::function<Vector2d(double s)>& profile,
    double length) {
  double widest = 0;
  for (int i = 0; i <= 32; ++i) {
    widest = std::max(widest, profile(i / 32.0).x());
  }
  RoomSurface surface;
  surface.name = name;
  surface.paint = paint;
  const double around = kTwoPi * widest;
  surface.size = {static_cast<float>(around), static_cast<float>(length)};
  surface.at = [=](double u, double v) {
    const double angle = kTwoPi * u / around, s = v / length, step = 1e-4;
    const double s0 = std::max(0.0, s - step), s1 = std::min(1.0, s + step);
    const Vector2d p = profile(s), d = profile(s1) - profile(s0);
    const Vector2d n = Vector2d(d.y(), -d.x()).normalized();
    const double c = std::cos(angle), sn = std::sin(angle);
    SurfacePoint point;
    point.position = frame(p.x() * c, p.x() * sn, p.y());
    point.normal = frame.axes * Vector3d(n.x() * c, n.x() * sn, n.y());
    return point;
  };
  AddChartMesh(std::move(surface), 72, 48);
}

void RoomBuilder::AddCushion(const std::string& name,
                             const Paint& paint,
                             const RoomFrame& frame,
                             const Vector3d& half_size) {
  RoomSurface surface;
  surface.name = name;
  surface.paint = paint;
  const double around = 4 * (half_size.x() + half_size.y());
  const double length = 2 * std::max(half_size.x(), half_size.y());
  surface.size = {static_cast<float>(around), static_cast<float>(length)};
  const auto position = [=](double angle, double polar) {
    const auto squared = [](double x) {  // towards a square outline
      return std::copysign(std::pow(std::abs(x), 0.55), x);
    };
    const double r = std::pow(std::sin(polar), 0.8);
    return frame(half_size.x() * r * squared(std::cos(angle)),
                 half_size.y() * r * squared(std::sin(angle)),
                 half_size.z() * (1 - std::cos(polar)));
  };
  surface.at = [=](double u, double v) {
    constexpr double kPi = 0.5 * kTwoPi;
    const double angle = kTwoPi * u / around;
    const double polar = std::clamp(kPi * v / length, 1e-6, kPi - 1e-6);
    const double step = 1e-3;
    const Vector3d du =
        position(angle + step, polar) - position(angle - step, polar);
    const double low = std::max(1e-9, polar - step);
    const double high = std::min(kPi - 1e-9, polar + step);
    const Vector3d dv = position(angle, high) - position(angle, low);
    SurfacePoint point;
    point.position = position(angle, polar);
    point.normal = du.cross(dv).normalized();
    return point;
  };
  AddChartMesh(std::move(surface), 64, 32);
}

}  // namespace facet
