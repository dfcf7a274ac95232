// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// A furnished room as surfaces: geometry, paint, ground-truth planes. World: z
// up, floor at z = 0, about 5 x 4 x 2.6 m; normals point into the open space.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "geometry/plane.h"
#include "mesh/tri_mesh.h"
#include "synth/paint.h"

namespace facet {

struct SurfacePoint {
  Eigen::Vector3d position;
  Eigen::Vector3d normal;  // unit
};

// A piece of the room with one paint, charted by (u, v) in metres.
struct RoomSurface {
  std::string name;
  Paint paint;
  Eigen::Vector2f size = {0, 0};  // the chart is [0, size.x] x [0, size.y] [m]
  std::function<SurfacePoint(double u, double v)> at;
  bool curved = false;
  Plane plane;  // of planar surfaces
};

struct SynthRoom {
  TriMesh mesh;
  std::vector<RoomSurface> surfaces;
  std::vector<int> face_surface;  // of every face
  // Charts of the three corners of every face [m].
  std::vector<std::array<Eigen::Vector2f, 3>> face_uv;
  // Ground-truth label of every face: the id of the surface, which is that of
  // its plane; -1 on curved surfaces.
  std::vector<int> face_plane;
  Eigen::Vector3d size = {0, 0, 0};    // inner size of the room [m]
  Eigen::Vector3d lamp = {0, 0, 0};    // centre of a square lamp, facing down
  double lamp_size = 0;                // its side [m]
  Eigen::Vector3d window = {0, 0, 0};  // centre of the window
  Eigen::Vector3d window_normal = {0, 0, 0};
  Eigen::Vector2d window_size = {0, 0};
};

// A place with axes: x to the right, y away from the viewer, z up.
struct RoomFrame {
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();

  Eigen::Vector3d operator()(double x, double y, double z) const {
    return origin + axes * Eigen::Vector3d(x, y, z);
  }
  // Moved by (x, y, z) and turned by `yaw` [rad] about z.
  RoomFrame At(double x, double y, double z, double yaw = 0) const;
};

// Sides of a box, as bits.
enum BoxSide {
  kFront = 1,
  kBack = 2,
  kLeft = 4,
  kRight = 8,
  kTop = 16,
  kBottom = 32,
  kAllSides = 63
};

// Adds surfaces to a room.
class RoomBuilder {
 public:
  explicit RoomBuilder(SynthRoom* room) : room_(room) {}

  // The parallelogram o, o + a, o + a + b, o + b with a orthogonal to b and
  // normal a x b, without the rectangle `hole` = (a0, b0, a1, b1) [m] if that
  // is not empty. Returns the surface id.
  int AddRectangle(const std::string& name,
                   const Paint& paint,
                   const Eigen::Vector3d& o,
                   const Eigen::Vector3d& a,
                   const Eigen::Vector3d& b,
                   const Eigen::Vector4d& hole = Eigen::Vector4d::Zero());

  // A box that stands on frame's origin, centred in x and y. `paint_of` gives
  // the paint of a side. Its front looks along -y of the frame.
  void AddBox(const std::string& name,
              const RoomFrame& frame,
              const Eigen::Vector3d& size,
              const std::function<Paint(BoxSide)>& paint_of,
              int sides = kAllSides);

  // A closed surface about the z axis of the frame: (radius, height) at
  // s in [0, 1], from the bottom to the top; `length` is that of the profile.
  void AddRevolution(const std::string& name,
                     const Paint& paint,
                     const RoomFrame& frame,
                     const std::function<Eigen::Vector2d(double s)>& profile,
                     double length);

  // |x/a|^e + |y/b|^e to the 2/e, + |z/c|^2 = 1: a stuffed cushion, standing on
  // the frame's origin with its z axis along the frame's z.
  void AddCushion(const std::string& name,
                  const Paint& paint,
                  const RoomFrame& frame,
                  const Eigen::Vector3d& half_size);

 private:
  void AddQuad(int surface,
               const Eigen::Vector2d& low,
               const Eigen::Vector2d& high);
  void AddChartMesh(RoomSurface surface, int columns, int rows);

  SynthRoom* room_;
};

// The room of a seed: sizes, layout, colours and textures vary with it.
SynthRoom BuildRoom(uint64_t seed);

}  // namespace facet
