// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Errors of camera trajectories (method, Sec. 11.3; Sturm et al. 2012).
#pragma once

#include <cstddef>
#include <vector>

#include "geometry/common_motion.h"
#include "geometry/pose.h"
#include "rgbd/trajectory_io.h"

namespace facet {

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
