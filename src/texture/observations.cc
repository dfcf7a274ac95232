// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "texture/observations.h"

#include <algorithm>
#include <array>
#include <limits>

#include "texture/visibility.h"
#include "util/errors.h"
#include "util/parallel_for.h"

namespace facet {
namespace {

using Eigen::Vector3f;

// Consecutive texels of one plane that are refused together if possible.
constexpr size_t kBlockTexels = SightBatch::kCapacity;

struct TexelBlock {
  size_t begin = 0, end = 0;
  Ball ball;
};

struct FrameResult {
  std::vector<uint32_t> texel;
  std::array<size_t, kNumSights> sights = {};
};

std::vector<TexelBlock> MakeBlocks(const TexelSet& texels,
                                   const std::vector<Plane>& planes,
                                   SightPoints* points) {
  std::vector<TexelBlock> blocks;
  for (size_t begin = 0; begin < texels.size();) {
    size_t end = begin + 1;
    while (end < texels.size() && end - begin < kBlockTexels &&
           texels.plane[end] == texels.plane[begin]) {
      ++end;
    }
    blocks.push_back({begin, end, Ball()});
    begin = end;
  }
  ParallelFor(
      0,
      blocks.size(),
      [&](size_t b) {
        TexelBlock& block = blocks[b];
        const Plane& plane = planes[texels.plane[block.begin]];
        std::vector<Vector3f> q;
        for (size_t i = block.begin; i < block.end; ++i) {
          const Vector3f& p = texels.position[i];
          q.push_back(plane.Project(p.cast<double>()).cast<float>());
          points->Set(i, p, q.back());
        }
        block.ball = BallAround(q.data(), q.size());
      },
      64);
  return blocks;
}

// A set of texels, prepared for all keyframes.
class Candidates {
 public:
  Candidates(const TexelSet& texels, const std::vector<Plane>& planes)
      : texels_(texels), planes_(planes), points_(texels.size()) {
    if (texels.size() > std::numeric_limits<uint32_t>::max()) {
      throw UnsolvableError(
          "more than 4 billion texels; raise the texel size or the stride");
    }
    blocks_ = MakeBlocks(texels, planes, &points_);
  }

  FrameResult SeenFrom(const FrameView& view) const {
    FrameResult result;
    for (const TexelBlock& block : blocks_) {
      const Sight all = view.TestBall(block.ball);
      if (all != Sight::kVisible) {
        result.sights[static_cast<int>(all)] += block.end - block.begin;
        continue;
      }
      const Vector3f normal =
          planes_[texels_.plane[block.begin]].normal.cast<float>();
      SightBatch batch = points_.Batch(block.begin, block.end, normal);
      view.Test(&batch);
      for (int i = 0; i < batch.size; ++i) {
        ++result.sights[static_cast<int>(batch.sight[i])];
        if (batch.sight[i] == Sight::kVisible) {
          result.texel.push_back(static_cast<uint32_t>(block.begin) + i);
        }
      }
    }
    return result;
  }

 private:
  const TexelSet& texels_;
  const std::vector<Plane>& planes_;
  SightPoints points_;
  std::vector<TexelBlock> blocks_;
};

// Empties `results`, one a keyframe.
Observations Collect(size_t num_texels,
                     int min_views,
                     std::vector<FrameResult>* results,
                     VisibilityCounts* counts) {
  std::vector<uint16_t> views(num_texels, 0);
  for (const FrameResult& result : *results) {
    for (uint32_t i : result.texel) ++views[i];
  }
  Observations observations;
  observations.begin.push_back(0);
  for (FrameResult& result : *results) {
    for (uint32_t i : result.texel) {
      if (views[i] >= min_views) {
        observations.texel.push_back(i);
      } else {
        ++counts->too_few_views;
      }
    }
    observations.begin.push_back(observations.texel.size());
    std::vector<uint32_t>().swap(result.texel);
    const auto count = [&](Sight sight) {
      return result.sights[static_cast<int>(sight)];
    };
    counts->behind_or_far += count(Sight::kBehindOrFar);
    counts->outside_image += count(Sight::kOutsideImage);
    counts->grazing += count(Sight::kGrazing);
    counts->depth_missing += count(Sight::kDepthMissing);
    counts->depth_edge += count(Sight::kDepthEdge);
    counts->depth_disagrees += count(Sight::kDepthDisagrees);
    counts->mesh_edge += count(Sight::kMeshEdge);
    counts->occluded += count(Sight::kOccluded);
  }
  counts->candidates = num_texels * results->size();
  counts->used = observations.size();
  return observations;
}

}  // namespace

Observations Thinned(const Observations& observations, size_t limit) {
  const auto n =
      static_cast<uint32_t>((observations.size() + limit - 1) / limit);
  if (n <= 1) return observations;
  Observations thin;
  thin.begin.push_back(0);
  for (size_t k = 0; k + 1 < observations.begin.size(); ++k) {
    for (size_t i = observations.begin[k]; i < observations.begin[k + 1]; ++i) {
      const uint32_t texel = observations.texel[i];
      if (texel % n == 0) thin.texel.push_back(texel);
    }
    thin.begin.push_back(thin.texel.size());
  }
  return thin;
}

std::vector<Observations> ComputeObservations(
    const std::vector<const TexelSet*>& texels,
    const std::vector<Plane>& planes,
    const RayScene& scene,
    const RgbdSequence& sequence,
    const std::vector<int>& keyframes,
    const std::vector<Pose>& color_cam_from_world,
    const VisibilityOptions& options,
    std::vector<VisibilityCounts>* counts) {
  std::vector<Candidates> candidates;
  for (const TexelSet* set : texels) candidates.emplace_back(*set, planes);
  const bool needs_depth =
      options.test_sensor_depth || options.test_depth_edges;
  std::vector<std::vector<FrameResult>> results(
      texels.size(), std::vector<FrameResult>(keyframes.size()));
  ParallelFor(0, keyframes.size(), [&](size_t k) {
    const FrameView view(
        sequence.calibration(),
        color_cam_from_world[k],
        needs_depth ? sequence.LoadDepth(keyframes[k]) : cv::Mat(),
        scene,
        options);
    for (size_t set = 0; set < texels.size(); ++set) {
      results[set][k] = candidates[set].SeenFrom(view);
    }
  });
  std::vector<Observations> observations;
  if (counts) counts->clear();
  for (size_t set = 0; set < texels.size(); ++set) {
    VisibilityCounts total;
    observations.push_back(
        Collect(texels[set]->size(), options.min_views, &results[set], &total));
    if (counts) counts->push_back(total);
  }
  return observations;
}

}  // namespace facet
