// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Which keyframe sees which texel: the sets P_i of the paper (Sec. 3.3),
// computed once and frozen, so that energies stay comparable.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "render/ray_scene.h"
#include "rgbd/sequence.h"
#include "texture/texels.h"

namespace facet {

// Compressed rows: keyframe k sees texel[begin[k]] ... texel[begin[k+1] - 1],
// ascending.
struct Observations {
  std::vector<size_t> begin;    // num_keyframes + 1
  std::vector<uint32_t> texel;  // indices into the TexelSet

  size_t size() const { return texel.size(); }
};

// Those of every n-th texel, n the least for which at most `limit` (at least 1)
// remain on average.
Observations Thinned(const Observations& observations, size_t limit);

// The tests of method ch. 6, each with its own switch.
struct VisibilityOptions {
  double min_depth_m = 0.3, max_depth_m = 6.0;  // z of the texel [m]
  double image_margin_px = 5;                   // inside the colour image
  bool test_occlusion = true;                   // against the simplified mesh
  double occlusion_tolerance_m = 0.02;
  bool test_sensor_depth = true;  // |D - z| <= max(min_tol, 3 sigma(z) + 0.02)
  double min_depth_tolerance_m = 0.03;
  bool allow_missing_depth = false;
  bool test_angle = true;  // cos of viewing angle at the plane
  double max_angle_deg = 75;
  bool test_depth_edges = true;     // away from jumps of the sensor depth
  double depth_edge_jump_m = 0.05;  // jump > max(this, rel * z)
  double depth_edge_jump_rel = 0.03;
  int depth_edge_dilate_px = 3;
  bool test_mesh_edges = false;  // away from where a surface of the mesh ends
  double mesh_edge_jump_m = 0.008;  // jump > max(this, rel * z)
  double mesh_edge_jump_rel = 0.004;
  int mesh_edge_dilate_px = 3;
  int min_views = 2;  // texels seen by fewer keyframes leave the problem
};

// Why observations were refused, in the order of the tests (each candidate
// counts for the first test it fails).
struct VisibilityCounts {
  size_t candidates = 0, behind_or_far = 0, outside_image = 0, grazing = 0,
         depth_missing = 0, depth_edge = 0, depth_disagrees = 0, mesh_edge = 0,
         occluded = 0, too_few_views = 0, used = 0;
};

// Which keyframes see which texels. A texel is judged by its plane point q
// (distance, image, angle, sensor depth) and by the ray to its mesh point p
// (occlusion); see texture/visibility.h.
//   texels      sets that are told apart: one Observations each. A keyframe is
//               prepared once for all of them, which is most of the work.
//   planes      by cluster id: n.x + w = 0
//   scene       the simplified mesh the texels lie on
//   keyframes   indices into sequence.frames()
//   color_cam_from_world  one a keyframe
// Depth images that do not decode throw InputError. `counts` may be null, else
// it gets one element a set.
std::vector<Observations> ComputeObservations(
    const std::vector<const TexelSet*>& texels,
    const std::vector<Plane>& planes,
    const RayScene& scene,
    const RgbdSequence& sequence,
    const std::vector<int>& keyframes,
    const std::vector<Pose>& color_cam_from_world,
    const VisibilityOptions& options,
    std::vector<VisibilityCounts>* counts = nullptr);

}  // namespace facet
