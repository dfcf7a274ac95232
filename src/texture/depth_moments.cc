// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "texture/depth_moments.h"

#include <algorithm>
#include <cmath>

#include "rgbd/depth.h"
#include "util/errors.h"
#include "util/parallel_for.h"

namespace facet {
namespace {

using Eigen::Vector3d;

struct Sample {
  int plane = 0;
  double weight = 0;
  Vector3d x;  // colour camera
};

std::vector<Sample> SamplesOfFrame(const PlanarPartition& partition,
                                   const std::vector<Plane>& planes,
                                   const RayScene& scene,
                                   const RgbdCalibration& calibration,
                                   const cv::Mat& depth,
                                   const Pose& color_cam_from_world,
                                   const DepthMomentOptions& options) {
  const cv::Mat edges = DepthEdgeMask(depth, 0.05, 0.03, 3);
  const Pose world_from_depth =
      (calibration.color_from_depth.Inverse() * color_cam_from_world).Inverse();
  const double min_cos = std::cos(options.max_angle_deg * M_PI / 180);
  const int step = options.step_px;
  std::vector<Sample> samples;
  for (int row = step / 2; row < depth.rows; row += step) {
    for (int col = step / 2; col < depth.cols; col += step) {
      const double z = depth.at<float>(row, col);
      if (!(z > 0) || edges.at<uint8_t>(row, col) != 0) continue;
      const Vector3d ray = calibration.depth.Unproject(col, row);
      const Vector3d x = world_from_depth * (z * ray);
      const Vector3d direction = world_from_depth.rotation * ray;
      const double sigma = DepthSigma(z);
      const double tolerance =
          std::max(options.min_tolerance_m, 3 * sigma + 0.02);
      const RayHit hit = scene.Intersect(
          world_from_depth.translation, direction, 0, z + 4 * tolerance);
      if (hit.face < 0) continue;
      const int cluster = partition.face_cluster[hit.face];
      const Plane& plane = planes[cluster];
      if (-plane.normal.dot(direction) < min_cos * direction.norm()) continue;
      if (std::abs(plane.SignedDistance(x)) > tolerance) continue;
      const double rms = partition.clusters[cluster].rms;
      samples.push_back({cluster,
                         step * step / (sigma * sigma + rms * rms),
                         calibration.color_from_depth * (z * ray)});
    }
  }
  std::stable_sort(
      samples.begin(), samples.end(), [](const Sample& a, const Sample& b) {
        return a.plane < b.plane;
      });
  return samples;
}

}  // namespace

std::vector<DepthMoment> ComputeDepthMoments(
    const PlanarPartition& partition,
    const std::vector<Plane>& planes,
    const RayScene& scene,
    const RgbdSequence& sequence,
    const std::vector<int>& keyframes,
    const std::vector<Pose>& color_cam_from_world,
    const DepthMomentOptions& options) {
  if (options.step_px < 1) {
    throw OptionsError("the step of the depth samples must be at least 1");
  }
  std::vector<std::vector<DepthMoment>> of_frame(keyframes.size());
  ParallelFor(0, keyframes.size(), [&](size_t k) {
    const std::vector<Sample> samples =
        SamplesOfFrame(partition,
                       planes,
                       scene,
                       sequence.calibration(),
                       sequence.LoadDepth(keyframes[k]),
                       color_cam_from_world[k],
                       options);
    for (size_t begin = 0, end = 0; begin < samples.size(); begin = end) {
      DepthMoment moment;
      moment.keyframe = static_cast<int>(k);
      moment.plane = samples[begin].plane;
      for (; end < samples.size() && samples[end].plane == moment.plane;
           ++end) {
        const Eigen::Vector4d m = samples[end].x.homogeneous();
        moment.moment += samples[end].weight * m * m.transpose();
      }
      moment.samples = end - begin;
      if (moment.samples >= options.min_samples) of_frame[k].push_back(moment);
    }
  });
  std::vector<DepthMoment> moments;
  for (const auto& part : of_frame) {
    moments.insert(moments.end(), part.begin(), part.end());
  }
  return moments;
}

}  // namespace facet
