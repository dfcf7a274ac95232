// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Surfaces with their light, baked once into mip-mapped images. What a camera
// sees of a point then depends on the point alone (diffuse, static light), so
// the pictures of a room are photo-consistent by construction.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "render/ray_scene.h"
#include "synth/room.h"

namespace facet {

// An RGB image over the chart of a surface and its halvings.
class BakedTexture {
 public:
  BakedTexture() = default;
  // `step` [m] is the size of a texel; the chart is [0, size.x] x [0, size.y].
  BakedTexture(const Eigen::Vector2f& size, float step);

  int width() const { return levels_[0].width; }
  int height() const { return levels_[0].height; }
  // Texel (i, j) covers the chart around ((i + 0.5) step_u, (j + 0.5) step_v).
  float step_u() const { return step_u_; }
  float step_v() const { return step_v_; }
  void Set(int i, int j, const Eigen::Vector3f& rgb);
  // Builds the coarser levels; call after the last Set.
  void BuildLevels();

  // Colour in [0, 255], averaged over about `footprint` [m]: trilinear.
  Eigen::Vector3f Sample(float u, float v, float footprint) const;

 private:
  struct Level {
    int width = 0, height = 0;
    std::vector<uint8_t> rgb;
  };
  Eigen::Vector3f SampleLevel(const Level& level, float x, float y) const;

  std::vector<Level> levels_;
  float step_u_ = 1, step_v_ = 1;
};

struct BakeOptions {
  double room_step = 0.002;     // texel of walls, floor, ceiling [m]
  double thing_step = 0.00125;  // texel of furniture and what lies on it [m]
  double light_step = 0.06;     // lattice of the light between which it is
                                // interpolated [m]
};

// One texture a surface of the room: paint times light. The light is that of a
// square ceiling lamp and the window, with shadows, plus ambient light dimmed
// in corners. All threads; does not depend on their number.
std::vector<BakedTexture> BakeRoom(const SynthRoom& room,
                                   const RayScene& scene,
                                   const BakeOptions& options);

}  // namespace facet
