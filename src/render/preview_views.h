// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Three views that tell most about a scanned room.
#pragma once

#include <vector>

#include "render/picture.h"

namespace facet {

struct PreviewOptions {
  int width = 960, height = 720;    // [px]
  double inside_fov_deg = 70;       // horizontal, of the inside views
  double above_elevation_deg = 48;  // of the view from above
};

// Which way is up in the world: the direction most area faces (floors, seats,
// tables) within 50 degrees of the mean up of the cameras. Without cameras the
// same over all directions, which may well be a wall: pass some. Unit length.
Eigen::Vector3d EstimateUp(const TriMesh& mesh,
                           const std::vector<Pose>& cam_from_world);

// "above": from outside and above with back faces culled, from the side that
// most area faces; "inside_1", "inside_2": the two cameras that together see
// most surface. The inside views stand at given camera poses, or, without any,
// on a grid of places inside the bounding box. Deterministic. The mesh must
// have a face of positive area.
std::vector<PreviewView> ChooseViews(
    const RayScene& scene,
    const TriMesh& mesh,
    const std::vector<Pose>& cam_from_world = {},
    const PreviewOptions& options = PreviewOptions());

}  // namespace facet
