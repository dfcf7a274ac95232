// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "problems/tile_samples.h"

#include <cmath>
#include <limits>

namespace facet {
namespace {

constexpr int kMaxReweighting = 30;
constexpr float kStill = 1e-6f;  // [intensity]

bool NeedsWeights(const std::vector<PhotoChannel>& channels) {
  const std::vector<PhotoFrame>& frames = channels[0].frames;
  return !frames.empty() && (frames[0].loss != LossKind::kSquared ||
                             frames[0].out_of_image != OutOfImage::kFreeze);
}

}  // namespace

TileSlab::TileSlab(const TextureProblem& problem,
                   const std::vector<PhotoChannel>& channels,
                   const std::vector<PlaneAxes>& axes)
    : problem_(problem),
      channels_(channels),
      axes_(axes),
      samples_(channels.size()) {}

void TileSlab::Sample(size_t tile_begin, size_t tile_end) {
  const size_t segment_begin = problem_.tiles[tile_begin].segment_begin;
  const size_t segment_end = problem_.tiles[tile_end - 1].segment_end;
  const auto num_keyframes = static_cast<size_t>(problem_.NumKeyframes());
  const auto all = problem_.keyframe_segments.begin();
  runs_.assign(num_keyframes, Run());
  size_t total = 0;
  for (size_t k = 0; k < num_keyframes; ++k) {
    const auto begin =
        all + static_cast<ptrdiff_t>(problem_.keyframe_segment_begin[k]);
    const auto end =
        all + static_cast<ptrdiff_t>(problem_.keyframe_segment_begin[k + 1]);
    const auto first = std::lower_bound(begin, end, segment_begin);
    const auto last = std::lower_bound(first, end, segment_end);
    if (first == last) continue;
    Run& run = runs_[k];
    run.segment_begin = static_cast<size_t>(first - all);
    run.segment_end = static_cast<size_t>(last - all);
    run.first = problem_.segments[*first].begin;
    run.at = total;
    total += problem_.segments[*(last - 1)].end - run.first;
  }
  for (ChannelSamples& channel : samples_) {
    channel.intensity.resize(total);
    if (NeedsWeights(channels_)) channel.weight.resize(total);
    if (axes_.empty()) continue;
    channel.g1.resize(total);
    channel.g2.resize(total);
  }
  std::vector<PhotoCounts> counts(num_keyframes);
  ParallelFor(0, num_keyframes, [&](size_t k) {
    for (size_t c = 0; c < channels_.size(); ++c) {
      PhotoCounts other;
      SampleRun(c, static_cast<int>(k), c == 0 ? &counts[k] : &other);
    }
    problem_.ReleaseImages(static_cast<int>(k));
  });
  for (const PhotoCounts& c : counts) counts_ += c;
}

void TileSlab::SampleRun(size_t channel, int keyframe, PhotoCounts* counts) {
  const Run& run = runs_[keyframe];
  const PhotoFrame& frame = channels_[channel].frames[keyframe];
  const PhotoTexel* points = channels_[channel].points.data();
  const uint32_t* texel = problem_.observations.texel.data();
  ChannelSamples& samples = samples_[channel];
  const auto segment = [&](size_t i) -> const TileSegment& {
    return problem_.segments[problem_.keyframe_segments[i]];
  };
  for (size_t i = run.segment_begin; i < run.segment_end;) {
    // All segments at once; with axes, those of one plane.
    const size_t begin = segment(i).begin;
    const int plane = problem_.texels.plane[texel[begin]];
    do {
      ++i;
    } while (i < run.segment_end &&
             (axes_.empty() ||
              problem_.texels.plane[texel[segment(i).begin]] == plane));
    const size_t n = segment(i - 1).end - begin;
    const size_t at = run.at + begin - run.first;
    float* intensity = samples.intensity.data() + at;
    if (axes_.empty()) {
      GetPhotoKernel().sample(
          frame, points, texel + begin, n, intensity, counts);
    } else {
      GetPhotoKernel().sample_gradient(frame,
                                       axes_[plane].e1.data(),
                                       axes_[plane].e2.data(),
                                       points,
                                       texel + begin,
                                       n,
                                       intensity,
                                       samples.g1.data() + at,
                                       samples.g2.data() + at,
                                       counts);
    }
  }
}

TileSamples TileSlab::Of(size_t t, size_t channel) {
  const TexelTile& tile = problem_.tiles[t];
  const std::vector<PhotoFrame>& frames = channels_[channel].frames;
  TileSamples samples;
  for (size_t s = tile.segment_begin; s < tile.segment_end; ++s) {
    const Run& run = runs_[problem_.segments[s].keyframe];
    samples.offset.push_back(run.at + problem_.segments[s].begin - run.first);
  }
  samples.intensity = samples_[channel].intensity.data();
  if (!axes_.empty()) {
    samples.g1 = samples_[channel].g1.data();
    samples.g2 = samples_[channel].g2.data();
  }
  samples.mean.assign(tile.texel_end - tile.texel_begin, 0.0f);
  ForEachSample(problem_, tile, samples, [&](size_t, size_t texel, size_t i) {
    samples.mean[texel] += samples.intensity[i];
  });
  for (size_t i = 0; i < samples.mean.size(); ++i) {
    const uint16_t views = problem_.views[tile.texel_begin + i];
    if (views > 0) samples.mean[i] /= static_cast<float>(views);
  }
  if (NeedsWeights(channels_)) {
    samples.loss = frames[0].loss;
    samples.loss_scale = frames[0].loss_scale;
    Reweight(tile, channel, &samples);
  }
  return samples;
}

void TileSlab::Reweight(const TexelTile& tile,
                        size_t channel,
                        TileSamples* samples) {
  samples->mean.assign(samples->mean.size(),
                       std::numeric_limits<float>::quiet_NaN());
  ReweightMeans(problem_, tile, *samples, &samples->mean);
  float* weight = samples_[channel].weight.data();
  ForEachSample(problem_, tile, *samples, [&](size_t, size_t texel, size_t i) {
    const double r =
        static_cast<double>(samples->intensity[i]) - samples->mean[texel];
    weight[i] = std::isnan(r) ? 0.0f
                              : static_cast<float>(LossWeight(
                                    samples->loss, samples->loss_scale, r * r));
  });
  samples->weight = weight;
}

size_t SlabEnd(const TextureProblem& problem, size_t tile_begin) {
  constexpr size_t kSlabSamples = size_t{1} << 21;
  size_t samples = 0, end = tile_begin;
  while (end < problem.tiles.size() &&
         (end == tile_begin || samples < kSlabSamples)) {
    const TexelTile& tile = problem.tiles[end++];
    for (size_t s = tile.segment_begin; s < tile.segment_end; ++s) {
      samples += problem.segments[s].end - problem.segments[s].begin;
    }
  }
  return end;
}

double SumLoss(const TextureProblem& problem,
               const TexelTile& tile,
               const TileSamples& samples,
               const float* colors) {
  double sum = 0;
  if (!samples.weight) {
    ForEachSample(problem, tile, samples, [&](size_t, size_t texel, size_t i) {
      const double r =
          static_cast<double>(samples.intensity[i]) - colors[texel];
      sum += r * r;
    });
    return sum;
  }
  ForEachSample(problem, tile, samples, [&](size_t, size_t texel, size_t i) {
    const double r = static_cast<double>(samples.intensity[i]) - colors[texel];
    if (std::isnan(r)) return;
    sum += LossValue(samples.loss, samples.loss_scale, r * r);
  });
  return sum;
}

void ReweightMeans(const TextureProblem& problem,
                   const TexelTile& tile,
                   const TileSamples& samples,
                   std::vector<float>* colors) {
  std::vector<double> sum(colors->size()), weights(colors->size());
  for (int iteration = 0; iteration < kMaxReweighting; ++iteration) {
    sum.assign(sum.size(), 0.0);
    weights.assign(sum.size(), 0.0);
    ForEachSample(problem, tile, samples, [&](size_t, size_t texel, size_t i) {
      const double intensity = samples.intensity[i];
      if (std::isnan(intensity)) return;
      const double r = intensity - (*colors)[texel];
      const double w =
          std::isnan(r) ? 1.0
                        : LossWeight(samples.loss, samples.loss_scale, r * r);
      sum[texel] += w * intensity;
      weights[texel] += w;
    });
    bool still = true;
    for (size_t t = 0; t < sum.size(); ++t) {
      if (!(weights[t] > 0)) continue;  // nothing to go by: as it is
      const float next = static_cast<float>(sum[t] / weights[t]);
      still = still && std::abs(next - (*colors)[t]) <= kStill;
      (*colors)[t] = next;
    }
    if (still || samples.loss == LossKind::kSquared) return;
  }
}

}  // namespace facet
