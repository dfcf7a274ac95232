// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// All samples of one tile: the building block of the colour step, the energy
// and the joint solve.
#pragma once

#include <vector>

#include "costs/robust_loss.h"
#include "problems/texture_problem.h"

namespace facet {

// Observations of a tile, segment after segment.
struct TileSamples {
  std::vector<float> intensity;
  std::vector<float> g1, g2;   // if asked for: PhotoKernel::sample_gradient
  std::vector<size_t> offset;  // of each segment, plus the total
  std::vector<float> mean;  // the colour that minimises E_c, a tile texel: the
                            // mean over the observing keyframes, with a
                            // robust loss the weighted one; 0 (if samples
                            // are dropped: NaN) where there is none
  std::vector<float> weight;  // rho' of each sample about the mean, 0 for those
                              // dropped; empty: all 1
  LossKind loss = LossKind::kSquared;
  double loss_scale = 1;
  PhotoCounts counts;
};

// Samples the tile's plane points in all keyframes that observe it, with the
// loss of `frames`. With axes
// e1 and e2 (in-plane, unit) also the gradients. `samples` is reused memory.
void SampleTile(const TextureProblem& problem,
                const std::vector<PhotoFrame>& frames,
                const std::vector<PhotoTexel>& points,
                const TexelTile& tile,
                const float* e1,
                const float* e2,
                TileSamples* samples);

// Sum of rho((I - color)^2) over the tile's samples; colors by tile texel.
double SumLoss(const TextureProblem& problem,
               const TexelTile& tile,
               const TileSamples& samples,
               const float* colors);

// Iteratively reweighted means from `colors` (NaN: from the plain mean), by
// tile texel, until they stand still: at a minimum of sum rho. Each iteration
// lowers it (costs/robust_loss.h). Dropped samples do not count; NaN without
// samples.
void ReweightMeans(const TextureProblem& problem,
                   const TexelTile& tile,
                   const TileSamples& samples,
                   std::vector<float>* colors);

// Calls visit(segment index, texel index in the tile, sample index) for every
// sample, in order.
template <typename Visit>
void ForEachSample(const TextureProblem& problem,
                   const TexelTile& tile,
                   const TileSamples& samples,
                   const Visit& visit) {
  for (size_t s = tile.segment_begin; s < tile.segment_end; ++s) {
    const TileSegment& segment = problem.segments[s];
    const size_t offset = samples.offset[s - tile.segment_begin];
    for (size_t i = segment.begin; i < segment.end; ++i) {
      visit(s,
            problem.observations.texel[i] - tile.texel_begin,
            offset + i - segment.begin);
    }
  }
}

}  // namespace facet
