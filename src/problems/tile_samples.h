// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// All samples of one tile: the building block of the colour step, the energy and
// the joint solve.
#pragma once

#include <vector>

#include "problems/texture_problem.h"

namespace facet {

// Observations of a tile, segment after segment.
struct TileSamples {
  std::vector<float> intensity;
  std::vector<float> g1, g2;   // if asked for: PhotoKernel::sample_gradient
  std::vector<size_t> offset;  // of each segment, plus the total
  std::vector<float> mean;     // over the observing keyframes, a tile texel;
                               // 0 where there are none
  PhotoCounts counts;
};

// Samples the tile's plane points in all keyframes that observe it. With axes
// e1 and e2 (in-plane, unit) also the gradients. `samples` is reused memory.
void SampleTile(const TextureProblem& problem,
                const std::vector<PhotoFrame>& frames,
                const std::vector<PhotoTexel>& points,
                const TexelTile& tile,
                const float* e1,
                const float* e2,
                TileSamples* samples);

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
      visit(s, problem.observations.texel[i] - tile.texel_begin,
            offset + i - segment.begin);
    }
  }
}

}  // namespace facet
