// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "problems/tile_samples.h"

#include <gtest/gtest.h>

#include "problems/joint_rows.h"
#include "tests/support/tiny_scene.h"

namespace facet {
namespace {

// Every sample of a slab is the kernel's own of that observation alone, with
// the axes of its plane, however tiles are cut into slabs. Breaks if segments
// of two planes share their axes, or a slab mixes up its keyframes.
TEST(TileSlab, SamplesAreThoseOfSingleObservations) {
  TinySceneOptions options;
  options.texel_spacing_m = 0.02;  // more than one tile a plane
  const TinyScene scene = MakeTinyScene(options);
  const TextureProblem& problem = scene.problem;
  const std::vector<PhotoChannel> channels =
      MakePhotoChannels(problem, scene.truth, PointsAt::kPlane);
  const std::vector<PlaneAxes> axes = AxesOfPlanes(problem, scene.truth);
  const size_t num_tiles = problem.tiles.size();
  ASSERT_GT(num_tiles, 3u);
  TileSlab slab(problem, channels, axes);
  size_t visits = 0;
  for (const auto& [begin, end] : {std::make_pair(size_t{0}, size_t{2}),
                                   std::make_pair(size_t{2}, num_tiles)}) {
    slab.Sample(begin, end);
    for (size_t t = begin; t < end; ++t) {
      const TexelTile& tile = problem.tiles[t];
      const TileSamples samples = slab.Of(t, 0);
      ForEachSample(
          problem, tile, samples, [&](size_t s, size_t texel, size_t i) {
            if (++visits % 17 != 0) return;
            const auto id = static_cast<uint32_t>(tile.texel_begin + texel);
            float intensity, g1, g2;
            PhotoCounts counts;
            GetPhotoKernel().sample_gradient(
                channels[0].frames[problem.segments[s].keyframe],
                axes[tile.plane].e1.data(),
                axes[tile.plane].e2.data(),
                channels[0].points.data(),
                &id,
                1,
                &intensity,
                &g1,
                &g2,
                &counts);
            EXPECT_FLOAT_EQ(samples.intensity[i], intensity);
            EXPECT_FLOAT_EQ(samples.g1[i], g1);
            EXPECT_FLOAT_EQ(samples.g2[i], g2);
          });
    }
  }
  EXPECT_EQ(visits, problem.observations.size());
  EXPECT_EQ(slab.counts().used, problem.observations.size());
}

}  // namespace
}  // namespace facet
