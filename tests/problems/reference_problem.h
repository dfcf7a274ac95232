// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The energy as one plain Ceres problem: a residual block an observation
// (costs/photometric.h), no compression, all in double. The oracle of the
// optimiser's tests; for small scenes.
#pragma once

#include <ceres/loss_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <vector>

#include "costs/depth_moment.h"
#include "costs/photometric.h"
#include "costs/plane_manifold.h"
#include "costs/plane_moment.h"
#include "costs/se3_manifold.h"
#include "costs/warp_offset.h"
#include "problems/energy.h"
#include "problems/solve_blocks.h"

namespace facet {

class ReferenceProblem {
 public:
  // Works on `state` in place (colours: on a copy in double).
  ReferenceProblem(const TextureProblem& problem,
                   const EnergyWeights& weights,
                   ReconState* state)
      : problem_(problem),
        state_(state),
        colors_(state->colors.begin(), state->colors.end()) {
    for (int k = 0; k < problem.NumKeyframes(); ++k) AddKeyframe(k, weights);
    for (int j = 0; j < problem.NumPlanes(); ++j) {
      ceres_.AddResidualBlock(
          new PlaneMomentCost(problem.moments[j],
                              weights.texel_weight * weights.lambda1),
          nullptr,
          PlaneBlock(j));
      ceres_.SetManifold(PlaneBlock(j), new AnchoredPlaneManifold);
    }
  }

  double Cost() {
    double cost = 0;
    ceres_.Evaluate({}, &cost, nullptr, nullptr, nullptr);
    return cost;
  }

  // One Levenberg-Marquardt iteration over the free blocks of a BlockSet.
  void Step(unsigned free, ceres::LinearSolverType solver, int iterations = 1) {
    std::vector<double*> blocks;
    ceres_.GetParameterBlocks(&blocks);
    for (double* block : blocks) {
      if (!(Kind(block) & free)) ceres_.SetParameterBlockConstant(block);
    }
    ceres::Solver::Options options;
    options.linear_solver_type = solver;
    options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
    options.max_num_iterations = iterations;
    options.initial_trust_region_radius = 1e4;
    options.logging_type = ceres::SILENT;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &ceres_, &summary);
  }

  const std::vector<double>& colors() const { return colors_; }

 private:
  double* PlaneBlock(int j) { return state_->planes.data() + kPlaneSize * j; }
  double* PoseBlock(int k) { return state_->poses.data() + kPoseSize * k; }

  unsigned Kind(const double* block) const {
    const auto in = [block](const std::vector<double>& v) {
      return block >= v.data() && block < v.data() + v.size();
    };
    if (in(colors_)) return kColors;
    if (in(state_->planes)) return kPlanes;
    return in(state_->poses) ? kPoses : kWarps;
  }

  void AddKeyframe(int k, const EnergyWeights& weights) {
    const WarpLattice& lattice = problem_.lattice;
    double* warp = state_->warps.data() + 2 * lattice.NumVertices() * k;
    const Pose pose = state_->CamFromWorld(k);
    for (size_t i = problem_.observations.begin[k];
         i < problem_.observations.begin[k + 1];
         ++i) {
      const uint32_t texel = problem_.observations.texel[i];
      const int j = problem_.texels.plane[texel];
      const Eigen::Vector3d p = problem_.texels.position[texel].cast<double>();
      const Eigen::Vector2d u = problem_.camera.Project<double>(
          pose * ProjectOntoPlane(PlaneBlock(j), p, problem_.anchors[j]));
      const WarpCell c = lattice.Locate(u.x(), u.y());
      const auto vertex = [&](int a, int b) {
        return warp + 2 * lattice.VertexIndex(a, b);
      };
      ceres_.AddResidualBlock(
          PhotometricCost::Create(PhotometricCost(problem_.images[k],
                                                  problem_.camera,
                                                  lattice,
                                                  c.a,
                                                  c.b,
                                                  p,
                                                  problem_.anchors[j])),
          Scaled(weights.texel_weight),
          PoseBlock(k),
          PlaneBlock(j),
          &colors_[texel],
          vertex(c.a, c.b),
          vertex(c.a + 1, c.b),
          vertex(c.a, c.b + 1),
          vertex(c.a + 1, c.b + 1));
    }
    for (int l = 0; l < lattice.NumVertices(); ++l) {
      ceres_.AddResidualBlock(
          WarpOffsetCost::Create(), Scaled(weights.lambda2), warp + 2 * l);
    }
    ceres_.AddParameterBlock(PoseBlock(k), kPoseSize, new LeftSe3Manifold);
    for (const DepthMoment& d : problem_.depth_moments) {
      if (d.keyframe != k) continue;
      ceres_.AddResidualBlock(
          DepthMomentCost::Create(
              d.moment, problem_.anchors[d.plane], weights.DepthFactor()),
          nullptr,
          PoseBlock(k),
          PlaneBlock(d.plane));
    }
    if (!weights.pose_prior) return;
    ceres_.AddResidualBlock(
        PosePriorCost::Create(problem_.initial_cam_from_world[k],
                              weights.prior),
        nullptr,
        PoseBlock(k));
  }

  static ceres::LossFunction* Scaled(double weight) {
    return new ceres::ScaledLoss(nullptr, weight, ceres::TAKE_OWNERSHIP);
  }

  const TextureProblem& problem_;
  ReconState* state_;
  std::vector<double> colors_;
  ceres::Problem ceres_;
};

}  // namespace facet
