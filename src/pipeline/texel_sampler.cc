// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "pipeline/texel_sampler.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "util/errors.h"

namespace facet {
namespace {

// The coarse sample: every so many texels in both directions, in about so many
// keyframes.
constexpr int kProbeStride = 8;
constexpr size_t kProbeKeyframes = 32;
constexpr int kMaxStride = 32;

void CheckObserved(const Observations& observations,
                   const VisibilityCounts& c,
                   int num_keyframes) {
  if (observations.size() > 0) return;
  char text[700];
  std::snprintf(
      text,
      sizeof(text),
      "no keyframe sees the mesh: of %zu candidate observations of %d "
      "keyframes %zu are behind or too far, %zu outside the image, %zu "
      "grazing or from behind, %zu without depth, %zu at depth edges, %zu "
      "contradict the sensor depth, %zu at edges of the mesh, %zu are "
      "occluded, "
      "%zu seen too rarely; run "
      "facet-check-input to find the convention that fits, or lower "
      "--keyframe_window where texels are seen too rarely",
      c.candidates,
      num_keyframes,
      c.behind_or_far,
      c.outside_image,
      c.grazing,
      c.depth_missing,
      c.depth_edge,
      c.depth_disagrees,
      c.mesh_edge,
      c.occluded,
      c.too_few_views);
  throw UnsolvableError(text);
}

}  // namespace

TexelSampler::TexelSampler(const TriMesh& mesh,
                           const PlanarPartition& partition,
                           const std::vector<Plane>& planes,
                           const Atlas& atlas,
                           const RayScene& scene,
                           const RgbdSequence& sequence,
                           const std::vector<int>& keyframes,
                           const std::vector<Pose>& cam_from_world,
                           const VisibilityOptions& visibility,
                           const PhotometricOptions& options)
    : mesh_(mesh),
      partition_(partition),
      planes_(planes),
      atlas_(atlas),
      scene_(scene),
      sequence_(sequence),
      keyframes_(keyframes),
      cam_from_world_(cam_from_world),
      visibility_(visibility),
      options_(options) {
  for (const PlaneCluster& cluster : partition.clusters) {
    anchors_.push_back(cluster.centroid);
  }
}

SampledTexels TexelSampler::SampleGrid(int stride) const {
  SampledTexels sampled;
  sampled.texels =
      SampleTexels(mesh_, partition_, atlas_, {stride, options_.edge_margin_m});
  sampled.tiles = SortTexelsIntoTiles(
      planes_, anchors_, options_.tile_texels, &sampled.texels);
  return sampled;
}

int TexelSampler::ChooseStride() const {
  const size_t step =
      (keyframes_.size() + kProbeKeyframes - 1) / kProbeKeyframes;
  std::vector<int> some_keyframes;
  std::vector<Pose> some_poses;
  for (size_t k = 0; k < keyframes_.size(); k += step) {
    some_keyframes.push_back(keyframes_[k]);
    some_poses.push_back(cam_from_world_[k]);
  }
  VisibilityOptions visibility = visibility_;
  visibility.min_views = 1;  // that the other keyframes see them is likely
  const SampledTexels probe = SampleGrid(kProbeStride);
  const size_t seen = ComputeObservations({&probe.texels},
                                          planes_,
                                          scene_,
                                          sequence_,
                                          some_keyframes,
                                          some_poses,
                                          visibility)[0]
                          .size();
  // The count scales with 1 / stride^2.
  const double share = static_cast<double>(some_keyframes.size()) /
                       static_cast<double>(keyframes_.size());
  const double dense =
      static_cast<double>(seen) / share * kProbeStride * kProbeStride;
  const double stride = std::ceil(
      std::sqrt(dense / static_cast<double>(options_.max_observations)));
  return std::clamp(static_cast<int>(stride), 1, kMaxStride);
}

std::vector<SampledTexels> TexelSampler::Sample(
    const std::vector<int>& strides) const {
  std::vector<SampledTexels> samples;
  for (const int stride : strides) samples.push_back(SampleGrid(stride));
  std::vector<const TexelSet*> texels;
  for (const SampledTexels& sample : samples) texels.push_back(&sample.texels);
  std::vector<VisibilityCounts> counts;
  std::vector<Observations> observations = ComputeObservations(texels,
                                                               planes_,
                                                               scene_,
                                                               sequence_,
                                                               keyframes_,
                                                               cam_from_world_,
                                                               visibility_,
                                                               &counts);
  for (size_t i = 0; i < samples.size(); ++i) {
    CheckObserved(
        observations[i], counts[i], static_cast<int>(keyframes_.size()));
    samples[i].observations = std::move(observations[i]);
    samples[i].counts = counts[i];
  }
  return samples;
}

}  // namespace facet
