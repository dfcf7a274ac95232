// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "problems/tile_samples.h"

namespace facet {

void SampleTile(const TextureProblem& problem,
                const std::vector<PhotoFrame>& frames,
                const std::vector<PhotoTexel>& points,
                const TexelTile& tile,
                const float* e1,
                const float* e2,
                TileSamples* samples) {
  samples->counts = PhotoCounts();
  samples->offset.assign(1, 0);
  for (size_t s = tile.segment_begin; s < tile.segment_end; ++s) {
    const TileSegment& segment = problem.segments[s];
    samples->offset.push_back(samples->offset.back() + segment.end -
                              segment.begin);
  }
  samples->intensity.resize(samples->offset.back());
  if (e1) {
    samples->g1.resize(samples->offset.back());
    samples->g2.resize(samples->offset.back());
  }
  const PhotoKernel& kernel = GetPhotoKernel();
  for (size_t s = tile.segment_begin; s < tile.segment_end; ++s) {
    const TileSegment& segment = problem.segments[s];
    const size_t offset = samples->offset[s - tile.segment_begin];
    const PhotoFrame& frame = frames[segment.keyframe];
    const uint32_t* ids = problem.observations.texel.data() + segment.begin;
    const size_t n = segment.end - segment.begin;
    if (e1) {
      kernel.sample_gradient(frame, e1, e2, points.data(), ids, n,
                             samples->intensity.data() + offset,
                             samples->g1.data() + offset,
                             samples->g2.data() + offset, &samples->counts);
    } else {
      kernel.sample(frame, points.data(), ids, n,
                    samples->intensity.data() + offset, &samples->counts);
    }
  }
  samples->mean.assign(tile.texel_end - tile.texel_begin, 0.0f);
  ForEachSample(problem, tile, *samples, [&](size_t, size_t texel, size_t i) {
    samples->mean[texel] += samples->intensity[i];
  });
  for (size_t i = 0; i < samples->mean.size(); ++i) {
    const uint16_t views = problem.views[tile.texel_begin + i];
    if (views > 0) samples->mean[i] /= static_cast<float>(views);
  }
}

}  // namespace facet
