// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// From the light mesh to the texels that take part in the optimisation and the
// keyframes that see them.
#pragma once

#include <vector>

#include "pipeline/photometric_stage.h"

namespace facet {

struct SampledTexels {
  TexelSet texels;
  std::vector<TexelTile> tiles;
  Observations observations;
  VisibilityCounts counts;
};

// Keeps references: the arguments must outlive it.
class TexelSampler {
 public:
  TexelSampler(const TriMesh& mesh,
               const PlanarPartition& partition,
               const std::vector<Plane>& planes,
               const Atlas& atlas,
               const RayScene& scene,  // of the mesh
               const RgbdSequence& sequence,
               const std::vector<int>& keyframes,
               const std::vector<Pose>& cam_from_world,
               const VisibilityOptions& visibility,
               const PhotometricOptions& options);

  // Of the planes: their centroids.
  const std::vector<Eigen::Vector3d>& anchors() const { return anchors_; }

  // The least stride for which the observations should stay below
  // options.max_observations, by what some of the keyframes see of a coarse
  // sample.
  int ChooseStride() const;

  // One sample a stride; together is cheaper. Throws UnsolvableError, with the
  // counts of the tests, if no keyframe sees any texel of one.
  std::vector<SampledTexels> Sample(const std::vector<int>& strides) const;

 private:
  SampledTexels SampleGrid(int stride) const;

  const TriMesh& mesh_;
  const PlanarPartition& partition_;
  const std::vector<Plane>& planes_;
  const Atlas& atlas_;
  const RayScene& scene_;
  const RgbdSequence& sequence_;
  const std::vector<int>& keyframes_;
  const std::vector<Pose>& cam_from_world_;
  const VisibilityOptions& visibility_;
  const PhotometricOptions& options_;
  std::vector<Eigen::Vector3d> anchors_;
};

}  // namespace facet
