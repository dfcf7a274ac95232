// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "geometry/pinhole.h"
#include "geometry/pose.h"
#include "render/ray_scene.h"

namespace facet {

// z of the scene at the pixel centres of a camera [m], row-major, 0 where there
// is nothing: the depth of RenderDepth, in a small part of its time, by filling
// every triangle. What is nearer than 1 mm is cut off. On one thread. Between
// two triangles that share an edge no pixel is left out. Agrees with a ray to
// 1e-5 of the depth, but for pixel centres on an outline, which may fall to
// either side.
std::vector<float> RasterizeDepth(const RayScene& scene,
                                  const Pinhole& camera,
                                  const Pose& cam_from_world);

}  // namespace facet
