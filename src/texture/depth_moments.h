// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// What the depth images say about the planes, summed up for
// costs/depth_moment.h. Computed once and frozen, like the observations.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "geometry/plane.h"
#include "mesh/planar_partition.h"
#include "render/ray_scene.h"
#include "rgbd/sequence.h"

namespace facet {

// The depth samples of one keyframe on one plane.
struct DepthMoment {
  int keyframe = 0, plane = 0;
  size_t samples = 0;
  // sum of (x, 1)(x, 1)^T step^2 / variance, x in the colour camera [m].
  Eigen::Matrix4d moment = Eigen::Matrix4d::Zero();
};

struct DepthMomentOptions {
  int step_px = 8;  // every step-th pixel in both directions, at least 1
  // A sample belongs to the plane its ray meets in the mesh when both agree
  // within max(min_tolerance_m, 3 sigma(z) + 0.02 m) along the normal.
  double min_tolerance_m = 0.03;
  double max_angle_deg = 75;  // of ray and normal
  size_t min_samples = 12;    // of a keyframe on a plane; fewer are dropped
};

// Sorted by keyframe, then plane. `partition` is that of the mesh in `scene`;
// `planes` by cluster id. The variance of a sample is that of the sensor,
// DepthSigma(z)^2, plus the cluster's rms^2. Pixels within 3 px of a depth jump
// take no part. Throws OptionsError for a step below 1, InputError when a depth
// image does not decode.
std::vector<DepthMoment> ComputeDepthMoments(
    const PlanarPartition& partition,
    const std::vector<Plane>& planes,
    const RayScene& scene,
    const RgbdSequence& sequence,
    const std::vector<int>& keyframes,
    const std::vector<Pose>& color_cam_from_world,
    const DepthMomentOptions& options);

}  // namespace facet
