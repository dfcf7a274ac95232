// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// What stands in the synthetic room.
#pragma once

#include "synth/paint_maker.h"
#include "synth/room.h"

namespace facet {

// Furniture along a wall. `wall` as in room.cc: lower left corner, x along the
// wall, y through it. Roles: 0 window (cabinet below), 1 sofa, 2 bookcase,
// 3 door.
void FurnishWall(int role,
                 const RoomFrame& wall,
                 double length,
                 PaintMaker* paints,
                 RoomBuilder* builder);

// Table with chairs, boxes and a ball on the open floor. `sofa_wall` is the
// wall of role 1.
void FurnishFloor(const Eigen::Vector3d& room_size,
                  const RoomFrame& sofa_wall,
                  PaintMaker* paints,
                  RoomBuilder* builder);

}  // namespace facet
