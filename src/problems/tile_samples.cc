// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "problems/tile_samples.h"

#include <cmath>
#include <limits>

namespace facet {
namespace {

constexpr int kMaxReweighting = 30;
constexpr float kStill = 1e-6f;  // [intensity]

}  // namespace

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
      kernel.sample_gradient(frame,
                             e1,
                             e2,
                             points.data(),
                             ids,
                             n,
                             samples->intensity.data() + offset,
                             samples->g1.data() + offset,
                             samples->g2.data() + offset,
                             &samples->counts);
    } else {
      kernel.sample(frame,
                    points.data(),
                    ids,
                    n,
                    samples->intensity.data() + offset,
                    &samples->counts);
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
  samples->weight.clear();
  samples->loss = LossKind::kSquared;
  if (frames.empty() || (frames[0].loss == LossKind::kSquared &&
                         frames[0].out_of_image == OutOfImage::kFreeze)) {
    return;
  }
  samples->loss = frames[0].loss;
  samples->loss_scale = frames[0].loss_scale;
  samples->mean.assign(samples->mean.size(),
                       std::numeric_limits<float>::quiet_NaN());
  ReweightMeans(problem, tile, *samples, &samples->mean);
  samples->weight.resize(samples->intensity.size());
  ForEachSample(problem, tile, *samples, [&](size_t, size_t texel, size_t i) {
    const double r =
        static_cast<double>(samples->intensity[i]) - samples->mean[texel];
    samples->weight[i] = std::isnan(r)
                             ? 0.0f
                             : static_cast<float>(LossWeight(
                                   samples->loss, samples->loss_scale, r * r));
  });
}

double SumLoss(const TextureProblem& problem,
               const TexelTile& tile,
               const TileSamples& samples,
               const float* colors) {
  double sum = 0;
  if (samples.weight.empty()) {
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
