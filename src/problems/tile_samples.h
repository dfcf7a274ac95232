// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// All samples of one tile: what the colour step, the energy and the joint solve
// are made of. Samples are taken keyframe by keyframe, so that an image stays
// in the cache, and used tile by tile; slabs of tiles bound what is between.
#pragma once

#include <algorithm>
#include <vector>

#include "costs/robust_loss.h"
#include "problems/texture_problem.h"
#include "util/parallel_for.h"

namespace facet {

// The samples of a tile, one an observation. Arrays are those of the slab:
// sample i of segment s is at offset[s - tile.segment_begin] + i.
struct TileSamples {
  std::vector<size_t> offset;
  const float* intensity = nullptr;
  const float* g1 = nullptr;  // if asked for: PhotoKernel::sample_gradient
  const float* g2 = nullptr;
  const float* weight = nullptr;  // rho' about the mean, 0 for those dropped;
                                  // null: all 1
  std::vector<float> mean;  // the colour that minimises E_c, a tile texel: the
                            // mean over the observing keyframes, with a
                            // robust loss the weighted one; 0 (if samples
                            // are dropped: NaN) where there is none
  LossKind loss = LossKind::kSquared;
  double loss_scale = 1;
};

// In-plane directions, unit, along which samples get gradients.
struct PlaneAxes {
  Eigen::Vector3f e1, e2;
};

// Samples of consecutive tiles in all channels.
class TileSlab {
 public:
  // Samples at the points of each channel, with the loss of its frames. `axes`
  // by plane; empty: no gradients. All must outlive the slab.
  TileSlab(const TextureProblem& problem,
           const std::vector<PhotoChannel>& channels,
           const std::vector<PlaneAxes>& axes);

  // Samples the tiles [tile_begin, tile_end), on many threads.
  void Sample(size_t tile_begin, size_t tile_end);

  // Of one of these tiles. Valid until the next Sample(). May run on many
  // threads for different tiles.
  TileSamples Of(size_t tile, size_t channel);

  // Of the first channel, over all that was sampled.
  const PhotoCounts& counts() const { return counts_; }

 private:
  // Keyframe by keyframe, in the order of the observations.
  struct ChannelSamples {
    std::vector<float> intensity, g1, g2, weight;
  };
  // The observations of a keyframe within the slab.
  struct Run {
    size_t segment_begin = 0, segment_end = 0;  // into keyframe_segments
    size_t first = 0;                           // observation
    size_t at = 0;                              // its place in the arrays
  };

  void SampleRun(size_t channel, int keyframe, PhotoCounts* counts);
  void Reweight(const TexelTile& tile, size_t channel, TileSamples* samples);

  const TextureProblem& problem_;
  const std::vector<PhotoChannel>& channels_;
  const std::vector<PlaneAxes>& axes_;
  std::vector<Run> runs_;                // by keyframe
  std::vector<ChannelSamples> samples_;  // by channel
  PhotoCounts counts_;
};

// The end of the slab that begins with a tile: up to 2 million samples.
size_t SlabEnd(const TextureProblem& problem, size_t tile_begin);

// Calls use(tile, samples by channel) for every tile, on many threads. Returns
// the counts of the first channel.
template <typename Use>
PhotoCounts ForEachTile(const TextureProblem& problem,
                        const std::vector<PhotoChannel>& channels,
                        const std::vector<PlaneAxes>& axes,
                        const Use& use) {
  TileSlab slab(problem, channels, axes);
  for (size_t begin = 0; begin < problem.tiles.size();) {
    const size_t end = SlabEnd(problem, begin);
    slab.Sample(begin, end);
    ParallelFor(begin, end, [&](size_t t) {
      std::vector<TileSamples> samples;
      for (size_t c = 0; c < channels.size(); ++c) {
        samples.push_back(slab.Of(t, c));
      }
      use(t, &samples);
    });
    begin = end;
  }
  return slab.counts();
}

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
