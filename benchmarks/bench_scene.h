// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The scene of the benchmarks: the corner of a room
// (tests/support/tiny_scene.h) in images of the size of a depth camera's, with
// as many texels as give the wanted number of observations.
#pragma once

#include <vector>

#include "tests/support/tiny_scene.h"

namespace facet {

struct BenchSize {
  size_t observations = 0;  // about
  int keyframes = 0;
  int width = 640, height = 480;  // of the images [px]
};

// Poses are off by 3 mm and 0.1 degrees, planes by 2 mm and 0.1 degrees.
struct BenchScene {
  TinyScene scene;
  std::vector<std::vector<float>> more_pixels;  // Channels::kRgb
  ReconState start;
  EnergyWeights weights;
};

BenchScene MakeBenchScene(const BenchSize& size,
                          const Formulation& formulation = {});

// Changes sampling, losses and channels of a scene that is there already; its
// colours are averaged anew.
void SetFormulation(const Formulation& formulation, BenchScene* bench);

}  // namespace facet
