// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "problems/color_step.h"

#include "util/parallel_for.h"

namespace facet {

void SolveColors(const TextureProblem& problem, ReconState* state) {
  std::vector<float> warps;
  const std::vector<PhotoFrame> frames =
      MakePhotoFrames(problem, *state, false, &warps);
  const std::vector<PhotoTexel> points = PlanePoints(problem, *state);
  const PhotoKernel& kernel = GetPhotoKernel();
  ParallelFor(0, problem.tiles.size(), [&](size_t t) {
    const TexelTile& tile = problem.tiles[t];
    std::vector<float> sum(tile.texel_end - tile.texel_begin, 0.0f);
    std::vector<float> intensity(sum.size());
    PhotoCounts counts;
    for (size_t s = tile.segment_begin; s < tile.segment_end; ++s) {
      const TileSegment& segment = problem.segments[s];
      const uint32_t* ids = problem.observations.texel.data() + segment.begin;
      const size_t n = segment.end - segment.begin;
      kernel.sample(frames[segment.keyframe], points.data(), ids, n,
                    intensity.data(), &counts);
      for (size_t i = 0; i < n; ++i) {
        sum[ids[i] - tile.texel_begin] += intensity[i];
      }
    }
    for (size_t i = tile.texel_begin; i < tile.texel_end; ++i) {
      if (problem.views[i] == 0) continue;
      state->colors[i] =
          sum[i - tile.texel_begin] / static_cast<float>(problem.views[i]);
    }
  });
}

}  // namespace facet
