// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "problems/color_step.h"

#include "problems/tile_samples.h"
#include "util/parallel_for.h"

namespace facet {

void SolveColors(const TextureProblem& problem, ReconState* state) {
  std::vector<float> warps;
  const std::vector<PhotoFrame> frames =
      MakePhotoFrames(problem, *state, false, &warps);
  const std::vector<PhotoTexel> points = PlanePoints(problem, *state);
  ParallelFor(0, problem.tiles.size(), [&](size_t t) {
    const TexelTile& tile = problem.tiles[t];
    TileSamples samples;
    SampleTile(problem, frames, points, tile, nullptr, nullptr, &samples);
    for (size_t i = tile.texel_begin; i < tile.texel_end; ++i) {
      if (problem.views[i] > 0) {
        state->colors[i] = samples.mean[i - tile.texel_begin];
      }
    }
  });
}

}  // namespace facet
