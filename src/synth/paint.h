// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Painted surfaces of the synthetic room: reflectance as a function of a place
// on the surface. All styles are aperiodic with detail from 3 to 50 mm, except
// those that are meant to have little.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

namespace facet {

enum class PaintStyle {
  kPlaster,    // nearly uniform
  kWallpaper,  // scattered leaves on a fibrous ground
  kPlanks,     // wood floor
  kWood,       // one board
  kDoor,       // painted panels
  kDrawers,    // painted front with drawers
  kCarpet,     // woven bands and tufts
  kFabric,     // upholstery
  kTerrazzo,   // stone chips
  kMarble,     // veins
  kPatches,    // a toy ball
  kPoster,     // a picture with a caption
  kPrint,      // a page of text with a picture
  kCover,      // a book
  kCardboard,  // with tape and a printed label
  kOutside,    // what a window shows; gives light itself
};

struct Decal;

struct Paint {
  PaintStyle style = PaintStyle::kPlaster;
  uint32_t seed = 0;
  Eigen::Vector3f base = Eigen::Vector3f::Constant(0.7f);
  Eigen::Vector3f accent = Eigen::Vector3f::Constant(0.4f);
  // Things that lie flat on the surface; later ones cover earlier ones.
  std::vector<Decal> decals;
};

struct Decal {
  Eigen::Vector2f center = {0, 0};  // on the surface [m]
  float angle = 0;                  // [rad]
  Eigen::Vector2f size = {0, 0};    // [m]
  std::shared_ptr<const Paint> paint;
};

// Reflectance, RGB in [0, 1], at (u, v) [m] of a surface of the given size,
// u to the right and v up as seen from its front.
Eigen::Vector3f EvaluatePaint(const Paint& paint,
                              float u,
                              float v,
                              const Eigen::Vector2f& size);

}  // namespace facet
