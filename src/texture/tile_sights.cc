// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "texture/tile_sights.h"

#include <algorithm>

#include "texture/visibility.h"
#include "util/parallel_for.h"

namespace facet {
namespace {

using Eigen::Vector3f;

// One keyframe and all tiles.
class Looker {
 public:
  Looker(const TriMesh& mesh,
         const std::vector<Plane>& planes,
         const Atlas& atlas,
         const BakeTexels& texels,
         const VisibilityOptions& options,
         bool mild)
      : mesh_(mesh),
        planes_(planes),
        atlas_(atlas),
        texels_(texels),
        options_(options),
        mild_(mild),
        first_(FirstSources(texels)),
        points_(first_.back()),
        bit_(first_.back()),
        balls_(texels.tiles.size()) {
    ParallelFor(0, texels.tiles.size(), [this](size_t t) {
      const BakeTile& tile = texels_.tiles[t];
      balls_[t] = BallAround(texels_.q.data() + tile.begin,
                             tile.owned_end - tile.begin);
      size_t n = first_[t];
      for (uint32_t i = tile.begin; i < tile.owned_end; ++i) {
        if (texels_.source[i] != i) continue;
        points_.Set(n, texels_.p[i], texels_.q[i]);
        bit_[n++] = i - tile.begin;
      }
    });
  }

  bool MaySee(const FrameView& view, size_t t) const {
    const Ball& ball = balls_[t];
    if (view.TestBall(ball) != Sight::kVisible) return false;
    const Chart& chart = atlas_.charts[texels_.tiles[t].chart];
    if (!options_.test_angle || chart.steep) return true;
    const float along = NormalOf(chart, texels_.tiles[t].begin)
                            .dot(view.center() - ball.center);
    return along >= -ball.radius;
  }

  // Sets the bits of a tile. Returns whether there are any.
  bool Look(const FrameView& view, size_t t, uint64_t* words) const {
    const BakeTile& tile = texels_.tiles[t];
    const Chart& chart = atlas_.charts[tile.chart];
    // On a steep chart every face has its own normal.
    const size_t most = chart.steep ? 1 : SightBatch::kCapacity;
    bool any = false;
    for (size_t begin = first_[t]; begin < first_[t + 1]; begin += most) {
      SightBatch batch =
          points_.Batch(begin,
                        std::min(begin + most, first_[t + 1]),
                        NormalOf(chart, tile.begin + bit_[begin]));
      view.Test(&batch);
      any |= SetBits(batch, begin, TileSights::NumWords(tile), words);
    }
    return any;
  }

 private:
  // By tile: how many tested texels are in those before; and all.
  static std::vector<size_t> FirstSources(const BakeTexels& texels) {
    std::vector<size_t> first = {0};
    for (const BakeTile& tile : texels.tiles) {
      size_t count = 0;
      for (uint32_t i = tile.begin; i < tile.owned_end; ++i) {
        count += texels.source[i] == i;
      }
      first.push_back(first.back() + count);
    }
    return first;
  }

  bool SetBits(const SightBatch& batch,
               size_t begin,
               size_t num_words,
               uint64_t* words) const {
    bool any = false;
    for (int i = 0; i < batch.size; ++i) {
      const bool visible = batch.sight[i] == Sight::kVisible;
      if (!visible && !(mild_ && batch.may_see[i])) continue;
      const uint32_t bit = bit_[begin + i];
      words[bit / 64 + (visible ? 0 : num_words)] |= uint64_t{1} << (bit % 64);
      any = true;
    }
    return any;
  }

  Vector3f NormalOf(const Chart& chart, size_t texel) const {
    return TexelNormal(mesh_, planes_, chart, texels_, texel);
  }

  const TriMesh& mesh_;
  const std::vector<Plane>& planes_;
  const Atlas& atlas_;
  const BakeTexels& texels_;
  const VisibilityOptions& options_;
  const bool mild_;
  // The texels that are tested, tile by tile from first_ on: their points, and
  // their places in the tile.
  std::vector<size_t> first_;
  SightPoints points_;
  std::vector<uint32_t> bit_;
  std::vector<Ball> balls_;  // by tile
};

}  // namespace

Vector3f TexelNormal(const TriMesh& mesh,
                     const std::vector<Plane>& planes,
                     const Chart& chart,
                     const BakeTexels& texels,
                     size_t texel) {
  if (chart.steep) {
    return mesh.FaceCross(texels.face[texel]).normalized().cast<float>();
  }
  const Vector3f n = planes[chart.plane].normal.cast<float>();
  return chart.back ? Vector3f(-n) : n;
}

TileSights::TileSights(const TriMesh& mesh,
                       const std::vector<Plane>& planes,
                       const Atlas& atlas,
                       const BakeTexels& texels,
                       const RayScene& scene,
                       const RgbdSequence& sequence,
                       const std::vector<int>& keyframes,
                       const std::vector<Pose>& color_cam_from_world,
                       const VisibilityOptions& options,
                       bool mild)
    : frames_(keyframes.size()), views_(texels.tiles.size()) {
  const Looker looker(mesh, planes, atlas, texels, options, mild);
  const bool needs_depth =
      options.test_sensor_depth || options.test_depth_edges;
  ParallelFor(0, keyframes.size(), [&](size_t k) {
    const FrameView view(
        sequence.calibration(),
        color_cam_from_world[k],
        needs_depth ? sequence.LoadDepth(keyframes[k]) : cv::Mat(),
        scene,
        options);
    FrameBits& bits = frames_[k];
    for (size_t t = 0; t < texels.tiles.size(); ++t) {
      if (!looker.MaySee(view, t)) continue;
      const size_t first_word = bits.words.size();
      bits.words.resize(first_word + 2 * NumWords(texels.tiles[t]), 0);
      if (looker.Look(view, t, bits.words.data() + first_word)) {
        bits.tile.push_back(static_cast<uint32_t>(t));
        bits.first_word.push_back(static_cast<uint32_t>(first_word));
      } else {
        bits.words.resize(first_word);
      }
    }
    bits.words.shrink_to_fit();
  });
  for (size_t k = 0; k < frames_.size(); ++k) {
    const FrameBits& bits = frames_[k];
    for (size_t i = 0; i < bits.tile.size(); ++i) {
      views_[bits.tile[i]].push_back(
          {static_cast<int>(k), bits.words.data() + bits.first_word[i]});
    }
  }
}

}  // namespace facet
