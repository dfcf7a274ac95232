// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "pipeline/photometric_level.h"

#include <cmath>
#include <utility>

#include "util/parallel_for.h"

namespace facet {
namespace {

ImageView<float> ViewOf(const cv::Mat& image) {
  return {image.ptr<float>(),
          image.cols,
          image.rows,
          static_cast<ptrdiff_t>(image.step1())};
}

}  // namespace

PhotometricLevel::PhotometricLevel(const LevelInputs& inputs,
                                   const KeyframeImages& images,
                                   int level,
                                   int stride,
                                   SampledTexels sampled)
    : images_(images), smoothed_(inputs.options.smoothing_sigma_px > 0) {
  const PhotometricOptions& options = inputs.options;
  problem_.formulation = options.formulation;
  problem_.camera = inputs.sequence.calibration().color.Level(level);
  problem_.lattice = {options.warp_columns,
                      options.warp_rows,
                      problem_.camera.width,
                      problem_.camera.height};
  for (size_t k = 0; k < images_.size(); ++k) {
    problem_.images.push_back(ViewOf(images_.smooth[k]));
  }
  if (options.solver.trace_rms_grey) MakeLuma();
  if (options.formulation.channels == Channels::kRgb) {
    AddChannels(options.smoothing_sigma_px);
  }
  problem_.texels = std::move(sampled.texels);
  problem_.observations = std::move(sampled.observations);
  problem_.tiles = std::move(sampled.tiles);
  problem_.anchors = inputs.anchors;
  problem_.initial_cam_from_world = inputs.cam_from_world;
  problem_.depth_moments = inputs.depth_moments;
  problem_.surface = inputs.surface;
  problem_.texels_per_m2 = std::pow(stride * inputs.texel_size_m, -2);
  if (images_.store.InFile()) {
    problem_.release_images = [this](int k) { Release(k); };
  }
  FinishTextureProblem(&problem_);
}

void PhotometricLevel::AddTerms(const std::vector<WeightedTerm>& terms,
                                const ReconState& start,
                                double texel_weight) {
  facet::AddTerms(terms, start, texel_weight, &problem_);
}

EnergyTerms PhotometricLevel::Evaluate(const EnergyWeights& weights,
                                       const ReconState& state) {
  const bool kept = !luma_.empty();
  if (!kept) MakeLuma();
  const EnergyTerms terms = EvaluateEnergy(problem_, weights, state, true);
  if (!kept) {
    problem_.raw_images.clear();
    luma_.clear();
  }
  return terms;
}

void PhotometricLevel::MakeLuma() {
  luma_ = images_.smooth;  // headers only
  if (smoothed_) {
    ParallelFor(0, luma_.size(), [&](size_t k) {
      luma_[k] = images_.store.Keep(LumaOf(images_, k));
    });
  }
  for (const cv::Mat& luma : luma_) {
    problem_.raw_images.push_back(ViewOf(luma));
  }
}

void PhotometricLevel::AddChannels(double sigma) {
  channels_.resize(images_.size());
  ParallelFor(0, channels_.size(), [&](size_t k) {
    channels_[k] = SmoothChannels(images_.rgb[k], images_.ExposureOf(k), sigma);
    for (cv::Mat& channel : channels_[k]) {
      channel = images_.store.Keep(channel);
    }
  });
  problem_.more_images.resize(2);
  for (size_t k = 0; k < channels_.size(); ++k) {
    problem_.images[k] = ViewOf(channels_[k][0]);
    problem_.more_images[0].push_back(ViewOf(channels_[k][1]));
    problem_.more_images[1].push_back(ViewOf(channels_[k][2]));
  }
}

void PhotometricLevel::Release(int keyframe) const {
  ReleasePages(images_.smooth[keyframe]);
  if (!luma_.empty()) ReleasePages(luma_[keyframe]);
  if (channels_.empty()) return;
  for (const cv::Mat& channel : channels_[keyframe]) ReleasePages(channel);
}

}  // namespace facet
