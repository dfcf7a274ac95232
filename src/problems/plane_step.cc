// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "problems/plane_step.h"

#include <ceres/problem.h>
#include <ceres/solver.h>

#include <algorithm>
#include <cmath>

#include "costs/plane_manifold.h"
#include "costs/plane_moment.h"
#include "costs/plane_photometric_cost.h"
#include "problems/reference_blocks.h"
#include "problems/term.h"
#include "util/parallel_for.h"

namespace facet {
namespace {

std::vector<PlaneSegment> SegmentsOfPlane(const TextureProblem& problem,
                                          int plane) {
  std::vector<PlaneSegment> segments;
  for (size_t t = problem.plane_tile_begin[plane];
       t < problem.plane_tile_begin[plane + 1];
       ++t) {
    for (size_t s = problem.tiles[t].segment_begin;
         s < problem.tiles[t].segment_end;
         ++s) {
      const TileSegment& segment = problem.segments[s];
      segments.push_back({segment.keyframe,
                          problem.observations.texel.data() + segment.begin,
                          segment.end - segment.begin});
    }
  }
  return segments;
}

// Normalises (n, d), keeps the side of the normal and scales steps beyond the
// limits back towards `before`.
void LimitPlaneStep(const SolverConfig& config,
                    const Eigen::Vector4d& before,
                    double* plane) {
  Eigen::Map<Eigen::Vector4d> phi(plane);
  const double length = phi.head<3>().norm();
  if (!phi.allFinite() || length < 1e-12) {
    phi = before;
    return;
  }
  phi /= length;
  if (phi.head<3>().dot(before.head<3>()) < 0) phi = -phi;
  const double tilt =
      std::acos(std::clamp(phi.head<3>().dot(before.head<3>()), -1.0, 1.0));
  const double shift = std::abs(phi[3] - before[3]);
  const double scale = std::max({1.0,
                                 tilt / config.max_plane_tilt_rad,
                                 shift / config.max_plane_offset_m});
  if (scale > 1) {
    phi = before + (phi - before) / scale;
    phi.head<3>().normalize();
  }
}

double Cost(ceres::Problem* problem) {
  double cost = 0;
  problem->Evaluate({}, &cost, nullptr, nullptr, nullptr);
  return cost;
}

ceres::Solver::Options PlaneSolverOptions(const SolverConfig& config,
                                          double radius) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = config.max_plane_iterations;
  options.initial_trust_region_radius = radius;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;
  options.function_tolerance = 1e-6;
  return options;
}

}  // namespace

void SolvePlanes(const TextureProblem& problem,
                 const EnergyWeights& weights,
                 const SolverConfig& config,
                 SolverMemory* memory,
                 ReconState* state,
                 PhaseSummary* summary) {
  const size_t num_planes = static_cast<size_t>(problem.NumPlanes());
  if (memory->plane_radius.size() != num_planes) {
    memory->plane_radius.assign(num_planes, 1e4);
  }
  if (memory->plane_rest.size() != num_planes) {
    memory->plane_rest.assign(num_planes, RestMemory());
  }
  const std::vector<PhotoChannel> channels =
      MakePhotoChannels(problem, *state, PointsAt::kMesh);
  const double photo_weight = weights.texel_weight / problem.NumChannels();
  const TermBlocks terms(problem, weights);
  std::vector<int> iterations(num_planes, 0), reverted(num_planes, 0);
  std::vector<int> resting(num_planes, 0);
  std::vector<double> cost_start(num_planes, 0.0), cost_end(num_planes, 0.0);

  const auto release = [&](const std::vector<PlaneSegment>& segments) {
    for (const PlaneSegment& segment : segments) {
      problem.ReleaseImages(segment.keyframe);
    }
  };
  ParallelFor(0, num_planes, [&](size_t j) {
    const std::vector<PlaneSegment> segments =
        SegmentsOfPlane(problem, static_cast<int>(j));
    if (segments.empty()) return;
    double* plane = state->planes.data() + kPlaneSize * j;
    const Eigen::Vector4d before = Eigen::Map<Eigen::Vector4d>(plane);

    ceres::Problem ceres_problem;
    ceres_problem.AddParameterBlock(
        plane,
        kPlaneSize,
        CreatePlaneManifold(problem.formulation.plane, problem.anchors[j]));
    if (problem.formulation.evaluation == Evaluation::kReference) {
      AddReferencePlane(problem,
                        *state,
                        segments,
                        static_cast<int>(j),
                        photo_weight,
                        plane,
                        &ceres_problem);
    } else {
      for (const PhotoChannel& channel : channels) {
        ceres_problem.AddResidualBlock(
            new PlanePhotometricCost(channel.frames,
                                     segments,
                                     channel.points.data(),
                                     problem.anchors[j] - problem.origin,
                                     photo_weight),
            nullptr,
            plane);
      }
    }
    ceres_problem.AddResidualBlock(
        new PlaneMomentCost(problem.moments[j],
                            weights.texel_weight * weights.lambda1),
        nullptr,
        plane);
    terms.AddPlane(static_cast<int>(j), state, &ceres_problem);
    const double cost_before = Cost(&ceres_problem);
    RestMemory& rest = memory->plane_rest[j];
    if (Rests(cost_before, config.active_tolerance, &rest)) {
      cost_start[j] = cost_end[j] = 2 * cost_before;
      resting[j] = 1;
      release(segments);
      return;
    }
    ceres::Solver::Summary solved;
    ceres::Solve(PlaneSolverOptions(config, memory->plane_radius[j]),
                 &ceres_problem,
                 &solved);
    iterations[j] = static_cast<int>(solved.iterations.size());
    cost_start[j] = 2 * solved.initial_cost;
    cost_end[j] = 2 * solved.final_cost;
    if (!solved.iterations.empty()) {
      memory->plane_radius[j] =
          std::clamp(solved.iterations.back().trust_region_radius, 1e-2, 1e8);
    }
    LimitPlaneStep(config, before, plane);
    double cost = Cost(&ceres_problem);
    if (!(cost <= cost_before)) {
      Eigen::Map<Eigen::Vector4d>(plane, 4) = before;
      cost = cost_before;
      reverted[j] = 1;
    }
    rest = RestAfter(solved, cost_before, cost, config.active_tolerance);
    release(segments);
  });
  for (size_t j = 0; j < num_planes; ++j) {
    summary->problems += iterations[j] > 0 ? 1 : 0;
    summary->iterations += iterations[j];
    summary->reverted += reverted[j];
    summary->resting += resting[j];
    summary->cost_before += cost_start[j];
    summary->cost_after += cost_end[j];
  }
}

}  // namespace facet
