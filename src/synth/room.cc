// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "synth/room.h"

#include <cmath>

#include "synth/furniture.h"
#include "synth/procedural.h"

namespace facet {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

// A wall seen from inside: the frame's origin is its lower left corner, x runs
// along it, y points through it to the outside.
struct Wall {
  RoomFrame frame;
  double length = 0;
};

Wall WallOf(const Vector3d& room, int k) {
  // Counter-clockwise seen from above, each starting at its left corner as seen
  // from inside.
  const Vector3d corners[4] = {
      {room.x(), 0, 0}, {room.x(), room.y(), 0}, {0, room.y(), 0}, {0, 0, 0}};
  const Vector3d out[4] = {{0, -1, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}};
  Wall wall;
  wall.frame.origin = corners[k];
  wall.frame.axes << out[k].cross(Vector3d::UnitZ()), out[k], Vector3d::UnitZ();
  wall.length = k % 2 ? room.y() : room.x();
  return wall;
}

// Floor and sides of a hole in a wall and the panel at its end.
void AddRecess(const std::string& name,
               const RoomFrame& wall,
               const Eigen::Vector4d& hole,
               double depth,
               const Paint& sides,
               const Paint& panel,
               RoomBuilder* builder) {
  const double x0 = hole[0], z0 = hole[1], x1 = hole[2], z1 = hole[3];
  const Vector3d w = wall.axes.col(0) * (x1 - x0);
  const Vector3d h = wall.axes.col(2) * (z1 - z0);
  const Vector3d d = wall.axes.col(1) * depth;
  builder->AddRectangle(name + ".panel", panel, wall(x0, depth, z0), w, h);
  if (z0 > 0) {
    builder->AddRectangle(name + ".sill", sides, wall(x0, 0, z0), w, d);
  } else {  // the floor runs on into the recess
    builder->AddRectangle(name + ".floor", sides, wall(x0, 0, z0), w, d);
  }
  builder->AddRectangle(name + ".lintel", sides, wall(x0, depth, z1), w, -d);
  builder->AddRectangle(name + ".left", sides, wall(x0, 0, z0), d, h);
  builder->AddRectangle(name + ".right", sides, wall(x1, depth, z0), -d, h);
}

Paint WallPaint(int k, PaintMaker* paints) {
  Paint paint;
  // Two papered walls, two that give little to hold on to.
  if (k % 2 == 0) {
    paint = paints->Make(PaintStyle::kWallpaper);
    const float hue = paints->Unit();
    paint.base = HsvColor(hue, 0.12f, 0.82f);
    paint.accent = HsvColor(hue + 0.1f * paints->Unit(), 0.35f, 0.6f);
  } else {
    paint = paints->Make(PaintStyle::kPlaster);
    paint.base = HsvColor(paints->Unit(), 0.10f, 0.8f);
  }
  return paint;
}

void AddFloorAndCeiling(SynthRoom* room,
                        PaintMaker* paints,
                        RoomBuilder* builder) {
  const double x = room->size.x(), y = room->size.y(), z = room->size.z();
  Paint floor = paints->Make(PaintStyle::kPlanks);
  floor.base = HsvColor(0.07f + 0.03f * paints->Unit(), 0.5f, 0.62f);
  floor.accent = 0.55f * floor.base;
  Decal rug;
  rug.size = {2.0f, 1.4f};
  rug.center = {static_cast<float>(x * (0.42 + 0.16 * paints->Unit())),
                static_cast<float>(y * (0.42 + 0.16 * paints->Unit()))};
  rug.angle = 0.5f * (paints->Unit() - 0.5f);
  auto carpet = std::make_shared<Paint>(paints->Make(PaintStyle::kCarpet));
  const float hue = paints->Unit();
  carpet->base = HsvColor(hue, 0.6f, 0.5f);
  carpet->accent = HsvColor(hue + 0.4f, 0.45f, 0.7f);
  rug.paint = carpet;
  floor.decals.push_back(rug);
  builder->AddRectangle("floor", floor, Vector3d::Zero(), {x, 0, 0}, {0, y, 0});
  Paint ceiling = paints->Make(PaintStyle::kPlaster);
  ceiling.base = Vector3f(0.88f, 0.87f, 0.84f);
  builder->AddRectangle("ceiling", ceiling, {0, y, z}, {x, 0, 0}, {0, -y, 0});
}

}  // namespace

SynthRoom BuildRoom(uint64_t seed) {
  SynthRoom room;
  PaintMaker paints(seed);
  RoomBuilder builder(&room);
  room.size = {
      paints.Range(4.8, 5.2), paints.Range(3.8, 4.2), paints.Range(2.5, 2.7)};
  AddFloorAndCeiling(&room, &paints, &builder);

  // Which wall has the window; the others follow clockwise or not.
  const int first = static_cast<int>(4 * paints.Unit());
  const int step = paints.Unit() < 0.5f ? 1 : 3;
  const Paint trim = [&] {
    Paint p = paints.Make(PaintStyle::kPlaster);
    p.base = Vector3f(0.85f, 0.84f, 0.8f);
    return p;
  }();
  for (int role = 0; role < 4; ++role) {
    const int k = (first + role * step) % 4;
    const Wall wall = WallOf(room.size, k);
    const Vector3d along = wall.frame.axes.col(0) * wall.length;
    const Vector3d up = wall.frame.axes.col(2) * room.size.z();
    Eigen::Vector4d hole = Eigen::Vector4d::Zero();
    if (role == 0) {  // window
      const double x = wall.length * paints.Range(0.3, 0.38);
      hole = {x, 0.95, x + paints.Range(1.3, 1.6), 2.15};
      AddRecess("window",
                wall.frame,
                hole,
                0.18,
                trim,
                paints.Make(PaintStyle::kOutside),
                &builder);
      room.window = wall.frame(
          0.5 * (hole[0] + hole[2]), 0.17, 0.5 * (hole[1] + hole[3]));
      room.window_normal = -wall.frame.axes.col(1);
      room.window_size = {hole[2] - hole[0], hole[3] - hole[1]};
    } else if (role == 3) {  // door
      const double x = wall.length * paints.Range(0.62, 0.68);
      hole = {x, 0, x + 0.92, 2.05};
      Paint door = paints.Make(PaintStyle::kDoor);
      door.base = HsvColor(paints.Unit(), 0.25f, 0.7f);
      AddRecess("door", wall.frame, hole, 0.12, trim, door, &builder);
    }
    builder.AddRectangle("wall_" + std::to_string(k),
                         WallPaint(role, &paints),
                         wall.frame.origin,
                         along,
                         up,
                         hole);
    FurnishWall(role, wall.frame, wall.length, &paints, &builder);
  }
  FurnishFloor(room.size,
               WallOf(room.size, (first + step) % 4).frame,
               &paints,
               &builder);
  room.lamp = {0.5 * room.size.x(), 0.5 * room.size.y(), room.size.z() - 0.02};
  room.lamp_size = 0.9;
  return room;
}

}  // namespace facet
