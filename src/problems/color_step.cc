// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "problems/color_step.h"

#include <cmath>

#include "problems/tile_samples.h"

namespace facet {
namespace {

// With a robust loss sum rho may have several minima: of the one reached from
// the plain mean and the one reached from the colours as they are the lower is
// taken, tile by tile, so that the step never raises E_c.
void KeepBetterColors(const TextureProblem& problem,
                      const TexelTile& tile,
                      const float* colors,
                      TileSamples* samples) {
  if (samples->loss == LossKind::kSquared) return;
  std::vector<float> from_here(colors, colors + samples->mean.size());
  ReweightMeans(problem, tile, *samples, &from_here);
  if (SumLoss(problem, tile, *samples, from_here.data()) <
      SumLoss(problem, tile, *samples, samples->mean.data())) {
    samples->mean = std::move(from_here);
  }
}

}  // namespace

void SolveColors(const TextureProblem& problem, ReconState* state) {
  const std::vector<PhotoChannel> channels =
      MakePhotoChannels(problem, *state, PointsAt::kPlane);
  ForEachTile(
      problem, channels, {}, [&](size_t t, std::vector<TileSamples>* samples) {
        const TexelTile& tile = problem.tiles[t];
        float* colors = state->colors.data();
        for (TileSamples& channel : *samples) {
          KeepBetterColors(problem, tile, colors + tile.texel_begin, &channel);
          for (size_t i = tile.texel_begin; i < tile.texel_end; ++i) {
            const float mean = channel.mean[i - tile.texel_begin];
            if (problem.views[i] > 0 && !std::isnan(mean)) colors[i] = mean;
          }
          colors += problem.texels.size();
        }
      });
}

}  // namespace facet
