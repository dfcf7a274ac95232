// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// A scene for the tests of the optimiser: the corner of a room, three walls
// that meet in the world's origin, painted with sums of cosines and seen by a
// few cameras. Images are rendered by intersecting rays with the planes, so
// that poses, planes and colours are known exactly. Everything is in memory and
// made in milliseconds.
#pragma once

#include <functional>
#include <vector>

#include "problems/energy.h"
#include "problems/texture_problem.h"

namespace facet {

struct TinySceneOptions {
  int keyframes = 8;
  int width = 160, height = 120;  // [px]
  double texel_spacing_m = 0.04;
  // The texels lie on a wavy mesh: this is the amplitude of the waves about the
  // plane [m]. 0 = a flat mesh, E_p = 0 at the truth.
  double relief_m = 0.003;
  // Side of square tiles (SortTexelsIntoTiles); 0 = rows, kTileTexels at a
  // time.
  int tile_texels = 0;
  double contrast = 0.3;  // of the paint; 0 = grey walls
  double image_margin_px = 6;
  int lattice_columns = 6, lattice_rows = 5;
  // Displacement f(k, u) of the pixels of keyframe k: its image I' is drawn so
  // that I'(u + f(k, u)) = I(u). Must be smooth and small. Empty = none.
  std::function<Eigen::Vector2d(int keyframe, const Eigen::Vector2d& u)>
      displacement;
};

// Move-only: the problem points at the images.
struct TinyScene {
  TinyScene() = default;
  TinyScene(TinyScene&&) = default;
  TinyScene& operator=(TinyScene&&) = default;

  TextureProblem problem;
  std::vector<Plane> planes;               // ground truth
  std::vector<Pose> cam_from_world;        // ground truth
  ReconState truth;                        // these, no warp, mean colours
  std::vector<std::vector<float>> pixels;  // row-major, width * height each
};

TinyScene MakeTinyScene(const TinySceneOptions& options = {});

// Depth samples of the true planes, as the true cameras see their texels, with
// a standard deviation of 1 mm.
void AddDepthMoments(TinyScene* scene);

// Turns every camera about its centre by `rotation_rad` and moves it by
// `translation_m`, both in random directions.
void PerturbPoses(double rotation_rad,
                  double translation_m,
                  uint64_t seed,
                  ReconState* state);

// Tilts every plane about its anchor by `tilt_rad` in a random direction and
// moves it by `offset_m` to a random side.
void PerturbPlanes(double tilt_rad,
                   double offset_m,
                   uint64_t seed,
                   ReconState* state);

// Makes `state` the start of an optimisation: centre of the pose prior, mean
// colours. Returns the weights of the paper for it.
EnergyWeights StartFrom(ReconState* state, TextureProblem* problem);

// Distance of a state from the truth after the best rigid alignment of the
// cameras: rms over cameras and planes.
struct StateError {
  double rotation_rad = 0, center_m = 0;  // of the cameras
  double normal_rad = 0, offset_m = 0;    // of the planes, at their anchors
};
StateError CompareToTruth(const TinyScene& scene, const ReconState& state);

}  // namespace facet
