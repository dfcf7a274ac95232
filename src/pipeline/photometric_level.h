// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The problem of one pyramid level of the photometric stage, with the images
// that it reads.
#pragma once

#include <array>
#include <opencv2/core.hpp>
#include <vector>

#include "pipeline/photometric_stage.h"
#include "pipeline/texel_sampler.h"
#include "problems/energy.h"
#include "problems/texture_problem.h"

namespace facet {

// The same for all levels.
struct LevelInputs {
  const PhotometricOptions& options;
  const RgbdSequence& sequence;
  const std::vector<Pose>& cam_from_world;
  const std::vector<Eigen::Vector3d>& anchors;
  const std::vector<DepthMoment>& depth_moments;
  const std::vector<SurfaceMoments>& surface;
  double texel_size_m;
};

class PhotometricLevel {
 public:
  // `images` and `sampled` are of that level.
  PhotometricLevel(const LevelInputs& inputs,
                   const KeyframeImages& images,
                   int level,
                   int stride,
                   SampledTexels sampled);
  PhotometricLevel(const PhotometricLevel&) = delete;  // problem refers to it
  PhotometricLevel& operator=(const PhotometricLevel&) = delete;

  const TextureProblem& problem() const { return problem_; }

  // Those of facet::AddTerms.
  void AddTerms(const std::vector<WeightedTerm>& terms,
                const ReconState& start,
                double texel_weight);

  // With rms_grey, for which luma is made if it is not kept.
  EnergyTerms Evaluate(const EnergyWeights& weights, const ReconState& state);

 private:
  void MakeLuma();
  void AddChannels(double sigma);
  void Release(int keyframe) const;

  KeyframeImages images_;
  bool smoothed_;
  std::vector<cv::Mat> luma_;
  std::vector<std::array<cv::Mat, 3>> channels_;
  TextureProblem problem_;
};

}  // namespace facet
