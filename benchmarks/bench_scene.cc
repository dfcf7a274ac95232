// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "benchmarks/bench_scene.h"

#include <algorithm>
#include <cmath>

#include "problems/color_step.h"

namespace facet {
namespace {

constexpr double kCoarseSpacing = 0.05;  // [m]
constexpr double kTileSide = 0.16;       // [m], at most 16 texels

TinySceneOptions OptionsOf(const BenchSize& size, double spacing) {
  TinySceneOptions options;
  options.keyframes = size.keyframes;
  options.width = size.width;
  options.height = size.height;
  options.texel_spacing_m = spacing;
  options.tile_texels =
      std::clamp(static_cast<int>(kTileSide / spacing), 1, 16);
  options.lattice_columns = 20;
  options.lattice_rows = 16;
  return options;
}

// Texels grow with the inverse square of their spacing: one coarse scene in
// small images tells how many of them are seen.
double SpacingFor(const BenchSize& size) {
  TinySceneOptions options = OptionsOf(size, kCoarseSpacing);
  options.image_margin_px *= 160.0 / size.width;
  options.width = 160;
  options.height = 160 * size.height / size.width;
  const TinyScene scene = MakeTinyScene(options);
  return kCoarseSpacing *
         std::sqrt(static_cast<double>(scene.problem.observations.size()) /
                   static_cast<double>(size.observations));
}

// Green and blue differ from red as the colours of one scene do: in contrast,
// not in structure. Every channel has memory of its own.
void MakeChannels(BenchScene* bench) {
  TextureProblem& problem = bench->scene.problem;
  bench->more_pixels.clear();
  problem.more_images.clear();
  if (problem.formulation.channels == Channels::kLuma) return;
  for (int channel = 1; channel < 3; ++channel) {
    std::vector<ImageView<float>> images;
    for (const std::vector<float>& red : bench->scene.pixels) {
      std::vector<float> pixels;
      for (const float x : red) pixels.push_back(x / (0.5f + 0.5f * channel));
      bench->more_pixels.push_back(std::move(pixels));
      images.push_back(problem.images[0]);
      images.back().data = bench->more_pixels.back().data();
    }
    problem.more_images.push_back(std::move(images));
  }
}

}  // namespace

void SetFormulation(const Formulation& formulation, BenchScene* bench) {
  TextureProblem& problem = bench->scene.problem;
  problem.formulation = formulation;
  MakeChannels(bench);
  FinishTextureProblem(&problem);
  bench->start.colors.assign(problem.NumChannels() * problem.texels.size(), 0);
  bench->weights = StartFrom(&bench->start, &problem);
}

BenchScene MakeBenchScene(const BenchSize& size,
                          const Formulation& formulation) {
  BenchScene bench;
  bench.scene = MakeTinyScene(OptionsOf(size, SpacingFor(size)));
  bench.start = bench.scene.truth;
  PerturbPoses(0.0017, 0.003, 1, &bench.start);
  PerturbPlanes(0.0017, 0.002, 2, &bench.start);
  SetFormulation(formulation, &bench);
  return bench;
}

}  // namespace facet
