// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Errors of camera trajectories (method, Sec. 11.3; Sturm et al. 2012) and the
// motion that two trajectories have in common.
#pragma once

#include <cstddef>
#include <vector>

#include "geometry/pose.h"
#include "rgbd/trajectory_io.h"

namespace facet {

// The rigid motion after_from_before, x' = R x + t in world coordinates, with
// how far it moves the centroid of the cameras and how far it turns them.
struct RigidMotion {
  Pose after_from_before;
  double mm = 0;
  double deg = 0;
};

// Least squares over the camera centres and over points 1 m from them along the
// three camera axes, so that orientations count as much as positions and one
// camera alone determines it. This is the "slide" of a model that was optimised
// without anything that holds the gauge.
//   before, after  cam_from_world of the same cameras, equally many
// Without cameras the identity.
RigidMotion CommonMotion(const std::vector<Pose>& before,
                         const std::vector<Pose>& after);

struct ErrorSummary {
  double rmse = 0, mean = 0, median = 0, max = 0;  // NaN without values
  size_t count = 0;
};
ErrorSummary Summarize(std::vector<double> errors);

// Relative pose error of pairs (i, j):
//   E = (Q_i^-1 Q_j)^-1 (P_i^-1 P_j),  Q true, P estimated world_from_cam.
struct RelativeError {
  ErrorSummary translation;  // [m]
  ErrorSummary rotation;     // [deg]
};

struct TrajectoryError {
  size_t matched = 0;     // frames in both
  ErrorSummary ate;       // of centres after the rigid alignment below [m]
  ErrorSummary absolute;  // of centres without alignment [m]
  ErrorSummary rotation;  // of orientations after the alignment [deg]
  RelativeError frame;    // frames that follow each other in the list
  RelativeError second;   // frames one second apart by their numbers
  RigidMotion slide;      // estimated from true: CommonMotion(true, estimated)
};

// Matches frames by number; ATE aligns centres by Umeyama's method without
// scale (three cameras at least, else no alignment). `frames_per_second` turns
// frame numbers into time. Throws InputError when no frame is in both.
TrajectoryError CompareTrajectories(const std::vector<NumberedPose>& estimated,
                                    const std::vector<NumberedPose>& truth,
                                    double frames_per_second);

}  // namespace facet
