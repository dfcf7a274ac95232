// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "synth/furniture.h"

#include <algorithm>
#include <cmath>

#include "synth/procedural.h"

namespace facet {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr int kNoBottom = kAllSides & ~kBottom;
constexpr int kAgainstWall = kNoBottom & ~kBack;

// One material on all sides, each with its own piece of it.
std::function<Paint(BoxSide)> AllSides(const Paint& paint) {
  return [paint](BoxSide side) {
    Paint p = paint;
    p.seed += 101u * static_cast<uint32_t>(side);
    return p;
  };
}

void AddPicture(const RoomFrame& wall,
                double x,
                double z,
                const Vector2d& size,
                PaintMaker* paints,
                RoomBuilder* builder) {
  const Paint poster = paints->Poster();
  Paint frame = paints->Wood();
  const double depth = paints->Range(0.02, 0.04);
  builder->AddBox(
      "picture",
      wall.At(x, -0.5 * depth, z),
      {size.x(), depth, size.y()},
      [&](BoxSide side) { return side == kFront ? poster : frame; },
      kAllSides & ~kBack);
}

// Books side by side from x0 to x1 on a board at height z, spines to the room.
void AddBookRow(const RoomFrame& wall,
                double x0,
                double x1,
                double z,
                double max_height,
                PaintMaker* paints,
                RoomBuilder* builder) {
  double x = x0;
  while (true) {
    const double width = paints->Range(0.025, 0.075);
    const double height = max_height * paints->Range(0.62, 0.92);
    const double depth = paints->Range(0.15, 0.22);
    if (x + width > x1) return;
    if (paints->Unit() < 0.10f) {  // a gap
      x += paints->Range(0.05, 0.15);
      continue;
    }
    Paint pages = paints->Print();
    pages.style = PaintStyle::kFabric;
    pages.base = Vector3f(0.85f, 0.82f, 0.74f);
    pages.accent = Vector3f(0.75f, 0.71f, 0.62f);
    const Paint cover = paints->Cover();
    builder->AddBox(
        "book",
        wall.At(x + 0.5 * width, -0.02 - 0.5 * depth, z),
        {width, depth, height},
        [&](BoxSide side) { return side == kTop ? pages : cover; },
        kAgainstWall);
    x += width + (paints->Unit() < 0.2f ? 0.012 : 0.001);
  }
}

void AddBookcase(const RoomFrame& wall,
                 double x,
                 PaintMaker* paints,
                 RoomBuilder* builder) {
  const double width = paints->Range(1.1, 1.4), depth = 0.32, board = 0.03;
  const double height = paints->Range(1.7, 1.95);
  const int shelves = 4;
  const Paint wood = paints->Wood();
  const auto sides = AllSides(wood);
  for (double side : {-0.5, 0.5}) {
    builder->AddBox("bookcase_side",
                    wall.At(x + side * (width - board), -0.5 * depth, 0),
                    {board, depth, height},
                    sides,
                    kAgainstWall);
  }
  const double pitch = (height - board) / shelves;
  const double inner = width - 2 * board;
  for (int i = 0; i <= shelves; ++i) {
    const double z = i * pitch;
    Paint p = wood;
    p.seed += 7000u + i;
    builder->AddBox("bookcase_board",
                    wall.At(x, -0.5 * depth, z),
                    {inner, depth, board},
                    AllSides(p),
                    kFront | kTop | (i > 0 ? kBottom : 0));
    if (i == shelves) break;
    const double full = paints->Range(0.55, 1.0) * inner;
    AddBookRow(wall,
               x - 0.5 * inner + 0.005,
               x - 0.5 * inner + full,
               z + board,
               pitch - board,
               paints,
               builder);
  }
}

void AddSofa(const RoomFrame& wall,
             double x,
             PaintMaker* paints,
             RoomBuilder* builder) {
  const double width = paints->Range(1.7, 2.0), depth = 0.85;
  const Paint fabric = paints->Fabric();
  builder->AddBox("sofa_seat",
                  wall.At(x, -0.5 * depth, 0),
                  {width - 0.36, depth, 0.42},
                  AllSides(fabric),
                  kFront | kTop);
  builder->AddBox("sofa_back",
                  wall.At(x, -0.11, 0.42),
                  {width - 0.36, 0.22, 0.40},
                  AllSides(fabric),
                  kFront | kTop);
  for (double side : {-0.5, 0.5}) {
    builder->AddBox("sofa_arm",
                    wall.At(x + side * (width - 0.18), -0.5 * depth, 0),
                    {0.18, depth, 0.60},
                    AllSides(fabric),
                    kAgainstWall);
  }
  for (int i = 0; i < 2; ++i) {
    const double place = x + (i ? 0.45 : -0.45) + paints->Range(-0.08, 0.08);
    RoomFrame frame = wall.At(place, -0.43, 0.43, paints->Range(-0.4, 0.4));
    // Leans against the back: its short axis points to the room and up.
    Eigen::Matrix3d lean;
    lean = Eigen::AngleAxisd(1.15, Vector3d::UnitX());
    frame.axes = frame.axes * lean;
    frame.origin = frame(0, 0.19, 0);
    builder->AddCushion("cushion", paints->Fabric(), frame, {0.22, 0.20, 0.07});
  }
}

void AddCabinet(const RoomFrame& wall,
                double x,
                PaintMaker* paints,
                RoomBuilder* builder) {
  const double width = paints->Range(1.2, 1.5);
  Paint front = paints->Wood();
  const Paint body = front;
  front.style = PaintStyle::kDrawers;
  builder->AddBox(
      "cabinet",
      wall.At(x, -0.22, 0),
      {width, 0.44, 0.72},
      [&](BoxSide side) { return side == kFront ? front : body; },
      kAgainstWall);
  for (int i = 0; i < 2; ++i) {
    const Paint cover = paints->Cover();
    builder->AddBox("book",
                    wall.At(x + paints->Range(-0.5, -0.1) * width,
                            -0.22,
                            0.72 + 0.035 * i,
                            paints->Range(-0.5, 0.5)),
                    {0.24, 0.17, 0.035},
                    AllSides(cover),
                    kNoBottom);
  }
  Paint marble = paints->Make(PaintStyle::kMarble);
  marble.base = HsvColor(paints->Unit(), 0.2f, 0.85f);
  marble.accent = HsvColor(paints->Unit(), 0.6f, 0.35f);
  builder->AddRevolution(
      "jar",
      marble,
      wall.At(x + 0.28 * width, -0.22, 0.72),
      [](double s) {
        return Vector2d(0.125 * std::sin(3.14159265 * std::pow(s, 0.7)) + 1e-5,
                        0.20 * s);
      },
      0.36);
}

void AddVase(const RoomFrame& place, PaintMaker* paints, RoomBuilder* builder) {
  Paint paint = paints->Make(PaintStyle::kMarble);
  paint.base = HsvColor(paints->Unit(), 0.45f, 0.75f);
  paint.accent = Vector3f(0.92f, 0.9f, 0.82f);
  const double height = paints->Range(0.24, 0.30);
  const double belly = paints->Range(0.065, 0.08);
  builder->AddRevolution(
      "vase",
      paint,
      place,
      [=](double s) {
        // Foot, belly, neck, closed by a shallow lid.
        const double t = std::clamp((s - 0.04) / 0.9, 0.0, 1.0);
        const double body =
            0.55 + 0.45 * std::sin(6.2831853 * std::pow(t, 0.8) * 0.86);
        const double close = std::min(1.0, std::min(s / 0.04, (1 - s) / 0.06));
        return Vector2d(belly * body * std::max(close, 1e-4), height * t);
      },
      1.35 * height);
}

void AddTable(const RoomFrame& place,
              PaintMaker* paints,
              RoomBuilder* builder) {
  const double width = paints->Range(1.3, 1.5), depth = 0.8, height = 0.74;
  Paint wood = paints->Wood();
  const auto plain = AllSides(wood);
  Paint top = wood;
  for (int i = 0; i < 3; ++i) {  // pages and magazines
    Decal page;
    page.size = {0.21f, 0.297f};
    page.center = {static_cast<float>(width * (0.2 + 0.3 * i) +
                                      paints->Range(-0.06, 0.06)),
                   static_cast<float>(depth * paints->Range(0.3, 0.7))};
    page.angle = static_cast<float>(paints->Range(-0.9, 0.9));
    page.paint =
        std::make_shared<Paint>(i == 1 ? paints->Poster() : paints->Print());
    top.decals.push_back(page);
  }
  builder->AddBox(
      "table_top",
      place.At(0, 0, height - 0.04),
      {width, depth, 0.04},
      [&](BoxSide side) { return side == kTop ? top : plain(side); });
  for (int i = 0; i < 4; ++i) {
    const double sx = i % 2 ? 0.5 : -0.5, sy = i / 2 ? 0.5 : -0.5;
    builder->AddBox("table_leg",
                    place.At(sx * (width - 0.14), sy * (depth - 0.14), 0),
                    {0.06, 0.06, height - 0.04},
                    plain,
                    kAllSides & ~(kTop | kBottom));
  }
  AddVase(place.At(paints->Range(-0.1, 0.1), paints->Range(0.15, 0.25), height),
          paints,
          builder);
  double z = height;
  for (int i = 0; i < 3; ++i) {
    const Vector3d size(paints->Range(0.2, 0.25),
                        paints->Range(0.15, 0.18),
                        paints->Range(0.022, 0.045));
    builder->AddBox("book",
                    place.At(-0.36 * width, 0.12, z, paints->Range(-0.5, 0.5)),
                    size,
                    AllSides(paints->Cover()),
                    kNoBottom);
    z += size.z();
  }
  const Vector3d box(0.24, 0.18, 0.13);
  Paint print = paints->Make(PaintStyle::kCardboard);
  print.base = HsvColor(paints->Unit(), 0.5f, 0.7f);
  print.accent = HsvColor(paints->Unit(), 0.5f, 0.5f);
  builder->AddBox("tea_box",
                  place.At(0.34 * width, 0.1, height, paints->Range(-0.6, 0.6)),
                  box,
                  AllSides(print),
                  kNoBottom);
}

void AddChair(const RoomFrame& place,
              PaintMaker* paints,
              RoomBuilder* builder) {
  const auto wood = AllSides(paints->Wood());
  const auto fabric = AllSides(paints->Fabric());
  builder->AddBox(
      "chair_seat", place.At(0, 0, 0.42), {0.44, 0.44, 0.05}, fabric);
  for (int i = 0; i < 4; ++i) {
    const double sx = i % 2 ? 0.19 : -0.19, sy = i / 2 ? 0.19 : -0.19;
    builder->AddBox("chair_leg",
                    place.At(sx, sy, 0),
                    {0.04, 0.04, 0.42},
                    wood,
                    kAllSides & ~(kTop | kBottom));
  }
  builder->AddBox("chair_back",
                  place.At(0, 0.20, 0.47),
                  {0.44, 0.04, 0.46},
                  wood,
                  kNoBottom);
}

}  // namespace

void FurnishWall(int role,
                 const RoomFrame& wall,
                 double length,
                 PaintMaker* paints,
                 RoomBuilder* builder) {
  const auto picture = [&](double x, double z, double w, double h) {
    AddPicture(wall, x * length, z, {w, h}, paints, builder);
  };
  switch (role) {
    case 0:
      AddCabinet(wall, 0.52 * length, paints, builder);
      picture(0.14, 1.2, 0.5, 0.65);
      picture(0.88, 1.25, 0.55, 0.42);
      break;
    case 1:
      AddSofa(wall, 0.52 * length, paints, builder);
      picture(0.28, 1.25, 0.62, 0.46);
      picture(0.52, 1.2, 0.5, 0.68);
      picture(0.76, 1.3, 0.6, 0.42);
      break;
    case 2:
      AddBookcase(wall, 0.32 * length, paints, builder);
      picture(0.68, 1.15, 0.8, 0.6);
      picture(0.88, 1.5, 0.35, 0.45);
      break;
    default:
      picture(0.25, 1.15, 0.7, 0.9);
      picture(0.48, 1.3, 0.4, 0.4);
  }
}

void FurnishFloor(const Vector3d& room_size,
                  const RoomFrame& sofa_wall,
                  PaintMaker* paints,
                  RoomBuilder* builder) {
  RoomFrame center;
  center.origin = {0.5 * room_size.x() + paints->Range(-0.2, 0.2),
                   0.5 * room_size.y() + paints->Range(-0.15, 0.15),
                   0};
  center.axes = sofa_wall.axes;
  const RoomFrame table = center.At(0, 0, 0, paints->Range(-0.15, 0.15));
  AddTable(table, paints, builder);
  AddChair(table.At(0.25, -0.62, 0, 3.14159 + paints->Range(-0.4, 0.4)),
           paints,
           builder);
  AddChair(table.At(-1.0, 0.05, 0, 1.5708 + paints->Range(-0.4, 0.4)),
           paints,
           builder);
  // Boxes in the corner left of the wall opposite of the sofa.
  const double along =
      std::abs(sofa_wall.axes(0, 0)) > 0.5 ? room_size.x() : room_size.y();
  const double across = room_size.x() + room_size.y() - along;
  const RoomFrame corner = sofa_wall.At(along - 0.5, -across + 0.55, 0);
  double z = 0;
  for (int i = 0; i < 2; ++i) {
    Paint cardboard = paints->Make(PaintStyle::kCardboard);
    cardboard.base =
        HsvColor(0.08f, 0.42f, static_cast<float>(paints->Range(0.55, 0.7)));
    cardboard.accent = Vector3f(0.75f, 0.68f, 0.5f);
    const Vector3d size(
        0.55 - 0.15 * i, 0.42 - 0.1 * i, paints->Range(0.3, 0.4));
    builder->AddBox("box",
                    corner.At(0, 0, z, paints->Range(-0.3, 0.3)),
                    size,
                    AllSides(cardboard),
                    kNoBottom);
    z += size.z();
  }
  const double r = paints->Range(0.11, 0.14);
  builder->AddRevolution(
      "ball",
      paints->Make(PaintStyle::kPatches),
      sofa_wall.At(0.45, -across + 0.5, 0),
      [r](double s) {
        const double a = 3.14159265358979 * s;
        return Vector2d(r * std::sin(a), r * (1 - std::cos(a)));
      },
      3.14159265 * r);
}

}  // namespace facet
