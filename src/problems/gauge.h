// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The gauge: what keeps the model where it was. E_c hardly notices when all
// cameras move together, the texture just slides over the mesh, and small
// systematic errors (calibration, depth) then drive the model away by
// centimetres (method, Sec. 7.6).
#pragma once

#include <ceres/cost_function.h>
#include <ceres/problem.h>

#include <cmath>

#include "problems/texture_problem.h"

namespace facet {

// The motion of all cameras since the start, by linear least squares over the
// camera centres and the points 1 m from them along the camera axes (the points
// of geometry/common_motion.h): with x their places at the start, c the mean of
// those and d = T_i^-1 T_i0 x - x,
//
//   tau = mean(d) [m],   omega = J^-1 sum (x - c) x d [rad],
//   J = sum |x - c|^2 I - (x - c)(x - c)^T
//
Vector6d MeanMotion(const std::vector<Pose>& initial_cam_from_world,
                    const std::vector<Pose>& cam_from_world);

// Takes the mean motion out of all poses: T_i <- T_i M. The texture moves back
// over the mesh, so colours must be averaged again.
void RemoveCommonMotion(const TextureProblem& problem, ReconState* state);

// The mean motion as a residual of the joint solve, so that its steps do not
// run along it in the first place.
//
//   Residual    weight * MeanMotion                              6
//   Parameters  all poses cam_from_world (costs/se3_manifold.h)  7 each
ceres::CostFunction* CreateCommonMotionCost(
    const std::vector<Pose>& initial_cam_from_world, double weight);

// The weight with which one millimetre costs `e_c`.
inline double CommonMotionWeight(double e_c) { return 1e3 * std::sqrt(e_c); }

// Adds it for the poses of `state`, with that weight.
void AddCommonMotionCost(const TextureProblem& problem,
                         double e_c,
                         ReconState* state,
                         ceres::Problem* ceres_problem);

}  // namespace facet
