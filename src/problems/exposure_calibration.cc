// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "problems/exposure_calibration.h"

#include <ceres/problem.h>
#include <ceres/solver.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "costs/exposure_cost.h"
#include "texture/rgb_sampler.h"
#include "util/parallel_for.h"
#include "util/warnings.h"

namespace facet {
namespace {

// What the keyframes see of the texels, texel by texel.
struct SampleTable {
  std::vector<size_t> begin;         // texels + 1
  std::vector<int> keyframe;         // ascending within a texel
  std::vector<Eigen::Vector3f> rgb;  // 0-1; NaN where clipped or outside
};

SampleTable PlaceSamples(size_t num_texels, const Observations& observations) {
  SampleTable table;
  table.begin.assign(num_texels + 1, 0);
  for (const uint32_t id : observations.texel) ++table.begin[id + 1];
  for (size_t i = 0; i < num_texels; ++i) table.begin[i + 1] += table.begin[i];
  table.keyframe.resize(observations.size());
  table.rgb.resize(observations.size());
  return table;
}

Eigen::Vector3f ColorSeen(const cv::Mat& rgb,
                          const Eigen::Vector2d& u,
                          const ExposureOptions& options) {
  const Eigen::Vector3f none =
      Eigen::Vector3f::Constant(std::numeric_limits<float>::quiet_NaN());
  if (!(u.x() >= 0 && u.y() >= 0 && u.x() <= rgb.cols - 1 &&
        u.y() <= rgb.rows - 1)) {
    return none;
  }
  const Eigen::Vector3f color =
      BilinearRgb(rgb, static_cast<float>(u.x()), static_cast<float>(u.y())) /
      255.0f;
  const bool clipped =
      color.minCoeff() < static_cast<float>(options.min_intensity) ||
      color.maxCoeff() > static_cast<float>(options.max_intensity);
  return clipped ? none : color;
}

SampleTable SampleColors(const TexelSet& texels,
                         const Observations& observations,
                         const std::vector<Plane>& planes,
                         const Pinhole& camera,
                         const std::vector<Pose>& cam_from_world,
                         const KeyframeImages& images,
                         const ExposureOptions& options) {
  SampleTable table = PlaceSamples(texels.size(), observations);
  std::vector<size_t> next(table.begin.begin(), table.begin.end() - 1);
  std::vector<size_t> slot(observations.size());
  for (size_t k = 0; k < images.size(); ++k) {
    for (size_t i = observations.begin[k]; i < observations.begin[k + 1]; ++i) {
      slot[i] = next[observations.texel[i]]++;
      table.keyframe[slot[i]] = static_cast<int>(k);
    }
  }
  ParallelFor(0, images.size(), [&](size_t k) {
    for (size_t i = observations.begin[k]; i < observations.begin[k + 1]; ++i) {
      const uint32_t id = observations.texel[i];
      const Eigen::Vector3d q =
          planes[texels.plane[id]].Project(texels.position[id].cast<double>());
      const Eigen::Vector3d y = cam_from_world[k] * q;
      table.rgb[slot[i]] =
          y.z() > 0 ? ColorSeen(images.rgb[k], camera.Project(y), options)
                    : Eigen::Vector3f::Constant(
                          std::numeric_limits<float>::quiet_NaN());
    }
    ReleasePages(images.rgb[k]);
  });
  return table;
}

// One channel: H of costs/exposure_cost.h and what it counts.
struct ChannelForm {
  Eigen::MatrixXd hessian;
  std::vector<double> count;  // samples by keyframe
};

// The samples of a texel that count, as keyframes and rows (I, 1).
struct TexelViews {
  std::vector<int> keyframe;
  std::vector<double> intensity;
};

void ViewsOf(const SampleTable& table,
             size_t texel,
             int channel,
             TexelViews* views) {
  views->keyframe.clear();
  views->intensity.clear();
  for (size_t i = table.begin[texel]; i < table.begin[texel + 1]; ++i) {
    const float value = table.rgb[i][channel];
    if (std::isnan(value)) continue;
    views->keyframe.push_back(table.keyframe[i]);
    views->intensity.push_back(value);
  }
}

ChannelForm MakeForm(const SampleTable& table,
                     size_t num_keyframes,
                     int channel) {
  ChannelForm form;
  const auto size = static_cast<Eigen::Index>(2 * num_keyframes);
  form.hessian = Eigen::MatrixXd::Zero(size, size);
  form.count.assign(num_keyframes, 0);
  TexelViews views;
  for (size_t texel = 0; texel + 1 < table.begin.size(); ++texel) {
    ViewsOf(table, texel, channel, &views);
    const size_t n = views.keyframe.size();
    if (n < 2) continue;
    const double share = 1.0 / static_cast<double>(n);
    for (size_t a = 0; a < n; ++a) {
      const Eigen::Vector2d va(views.intensity[a], 1);
      const int row = 2 * views.keyframe[a];
      form.count[views.keyframe[a]] += 1;
      for (size_t b = 0; b <= a; ++b) {
        const Eigen::RowVector2d vb(views.intensity[b], 1);
        form.hessian.block<2, 2>(row, 2 * views.keyframe[b]) -= share * va * vb;
      }
      form.hessian.block<2, 2>(row, row) += va * va.transpose();
    }
  }
  return form;
}

using ChannelExposures = std::vector<std::array<double, 2>>;

ChannelExposures Solve(const ChannelForm& form,
                       const ExposureOptions& options) {
  ChannelExposures exposures(form.count.size(), {1, 0});
  double total = 0;
  for (const double n : form.count) total += n;
  if (total == 0) return exposures;
  std::vector<double> shares;
  std::vector<double*> blocks;
  ceres::Problem problem;
  const double weight = std::sqrt(options.prior_observations) * options.noise;
  for (size_t k = 0; k < exposures.size(); ++k) {
    shares.push_back(form.count[k] / total);
    blocks.push_back(exposures[k].data());
    problem.AddResidualBlock(
        ExposurePriorCost::Create(weight / options.gain_sigma,
                                  weight / options.offset_sigma),
        nullptr,
        exposures[k].data());
  }
  problem.AddResidualBlock(
      new ExposureConsistencyCost(form.hessian), nullptr, blocks);
  // Heavy enough that the means do not give way to the consistency.
  problem.AddResidualBlock(
      ExposureMeanCost::Create(shares, 10 * std::sqrt(total)), nullptr, blocks);
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::DENSE_NORMAL_CHOLESKY;
  solver.max_num_iterations = 5;  // linear: the first step is the solution
  solver.initial_trust_region_radius = 1e16;
  solver.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  if (!summary.IsSolutionUsable()) {
    AddWarning("exposures: no solution, the keyframes stay as taken");
    exposures.assign(exposures.size(), {1, 0});
  }
  return exposures;
}

// Keyframes with an impossible gain in any channel stay as taken.
void DropImpossible(double max_gain, std::vector<Exposure>* exposures) {
  size_t dropped = 0;
  for (Exposure& exposure : *exposures) {
    const bool possible =
        exposure.gain.minCoeff() >= static_cast<float>(1 / max_gain) &&
        exposure.gain.maxCoeff() <= static_cast<float>(max_gain);
    if (possible) continue;
    exposure = Exposure();
    ++dropped;
  }
  if (dropped == 0) return;
  AddWarning("exposures: " + std::to_string(dropped) +
             " keyframes do not fit what the others see and stay as taken");
}

// Sum of (a I + b - C)^2 over the samples of a channel.
double SumOfSquares(const ChannelForm& form,
                    const ChannelExposures& exposures) {
  Eigen::VectorXd x(form.hessian.rows());
  for (size_t k = 0; k < exposures.size(); ++k) {
    x.segment<2>(static_cast<Eigen::Index>(2 * k)) << exposures[k][0],
        exposures[k][1];
  }
  return x.dot(form.hessian.selfadjointView<Eigen::Lower>() * x);
}

}  // namespace

ExposureCalibration CalibrateExposures(const TexelSet& texels,
                                       const Observations& observations,
                                       const std::vector<Plane>& planes,
                                       const Pinhole& camera,
                                       const std::vector<Pose>& cam_from_world,
                                       const KeyframeImages& images,
                                       const ExposureOptions& options) {
  const SampleTable table = SampleColors(
      texels, observations, planes, camera, cam_from_world, images, options);
  ExposureCalibration result;
  result.exposures.resize(images.size());
  std::array<ChannelForm, 3> forms;
  ParallelFor(0, 3, [&](size_t c) {
    forms[c] = MakeForm(table, images.size(), static_cast<int>(c));
    const ChannelExposures exposures = Solve(forms[c], options);
    for (size_t k = 0; k < images.size(); ++k) {
      result.exposures[k].gain[c] = static_cast<float>(exposures[k][0]);
      result.exposures[k].offset[c] = static_cast<float>(exposures[k][1]);
    }
  });
  DropImpossible(options.max_gain, &result.exposures);
  std::array<double, 3> count{}, before{}, after{};
  for (int c = 0; c < 3; ++c) {
    ChannelExposures exposures(images.size(), {1.0, 0.0});
    before[c] = SumOfSquares(forms[c], exposures);
    for (size_t k = 0; k < images.size(); ++k) {
      exposures[k] = {result.exposures[k].gain[c],
                      result.exposures[k].offset[c]};
    }
    after[c] = SumOfSquares(forms[c], exposures);
    for (const double n : forms[c].count) count[c] += n;
  }
  const double total = count[0] + count[1] + count[2];
  if (total == 0) return result;
  result.samples = static_cast<size_t>(total / 3);
  result.rms_before =
      255 * std::sqrt((before[0] + before[1] + before[2]) / total);
  result.rms_after = 255 * std::sqrt((after[0] + after[1] + after[2]) / total);
  result.min_grey = 1;
  for (const Exposure& exposure : result.exposures) {
    const Eigen::Array3f grey = 0.5f * exposure.gain + exposure.offset;
    result.min_grey =
        std::min(result.min_grey, static_cast<double>(grey.minCoeff()));
    result.max_grey =
        std::max(result.max_grey, static_cast<double>(grey.maxCoeff()));
  }
  return result;
}

}  // namespace facet
