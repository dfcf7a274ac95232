// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// How a person carries the camera through the room, and how poses go wrong.
#pragma once

#include <vector>

#include "render/ray_scene.h"
#include "synth/room.h"

namespace facet {

// `count` camera-from-world poses: two rounds through the room, the first one
// looking outwards at the nearer walls, the second one across the room, the
// view sweeping up and down. Keeps away from surfaces where the room allows
// (0.8 m), with the tremor of a hand. At 200 frames neighbours differ by about
// 6 cm and 5 degrees. Depends on seed and room only.
std::vector<Pose> HandHeldPath(const SynthRoom& room,
                               const RayScene& scene,
                               int count,
                               uint64_t seed);

// Wrong poses (method, Sec. 11.3): every frame's camera centre is moved by
// e = jitter + drift in world axes and its orientation turned by the rotation
// vector r = jitter + drift in camera axes. Each of the six components, seen as
// a series over the frames, is the sum of independent white noise and a smooth
// curve of a few periods, both with mean 0 and the same rms, scaled together so
// that the rms of the component over all frames is exactly
//
//   rms(e_x) = rms(e_y) = rms(e_z) = noise_mm,
//   rms(r_x) = rms(r_y) = rms(r_z) = noise_deg.
//
// The rms length of e is therefore sqrt(3) noise_mm. Needs at least 3 frames to
// hold; fewer are returned unchanged.
std::vector<Pose> PerturbPoses(const std::vector<Pose>& cam_from_world,
                               double noise_mm,
                               double noise_deg,
                               uint64_t seed);

}  // namespace facet
