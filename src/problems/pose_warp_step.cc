// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "problems/pose_warp_step.h"

#include <ceres/loss_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "costs/frame_cell_cost.h"
#include "costs/warp_offset.h"
#include "problems/cell_bins.h"
#include "problems/reference_blocks.h"
#include "problems/term.h"
#include "util/parallel_for.h"

namespace facet {
namespace {

ceres::Solver::Options FrameSolverOptions(const SolverConfig& config,
                                          bool with_warp,
                                          double radius) {
  ceres::Solver::Options options;
  if (with_warp) {
    options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
    options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
  } else {
    options.linear_solver_type = ceres::DENSE_QR;
  }
  options.max_num_iterations = config.max_pose_iterations;
  options.initial_trust_region_radius = radius;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;
  options.function_tolerance = 1e-6;
  return options;
}

// One keyframe's problem, its parameters in place in the state.
class FrameProblem {
 public:
  FrameProblem(const TextureProblem& problem,
               const EnergyWeights& weights,
               const TermBlocks& terms,
               unsigned blocks,
               const std::vector<PhotoChannel>& channels,
               int keyframe,
               ReconState* state)
      : texture_(problem),
        blocks_(blocks),
        pose_(state->poses.data() + kPoseSize * keyframe),
        warp_(state->warps.data() +
              2 * static_cast<size_t>(problem.lattice.NumVertices()) *
                  keyframe) {
    // A pose-only solve still sees a warp that is there already.
    with_warp_ =
        (blocks & kWarps) != 0 || channels[0].frames[keyframe].warp != nullptr;
    bins_ = BinByCell(problem,
                      channels[0].points,
                      state->CamFromWorld(keyframe),
                      keyframe,
                      !with_warp_);
    ceres_.AddParameterBlock(
        pose_, kPoseSize, CreatePoseManifold(problem.formulation.manifold));
    AddCells(channels, keyframe, *state, weights);
    if (with_warp_) AddWarpTerm(weights);
    if (blocks & kPoses) {
      terms.AddPose(keyframe, state, &ceres_);
    } else {
      ceres_.SetParameterBlockConstant(pose_);
    }
  }

  bool with_warp() const { return with_warp_; }
  ceres::Problem* ceres_problem() { return &ceres_; }

  double Cost() {
    double cost = 0;
    ceres_.Evaluate(
        ceres::Problem::EvaluateOptions(), &cost, nullptr, nullptr, nullptr);
    return cost;
  }

 private:
  double* Vertex(int column, int row) {
    return warp_ + 2 * texture_.lattice.VertexIndex(column, row);
  }

  void AddCells(const std::vector<PhotoChannel>& channels,
                int keyframe,
                const ReconState& state,
                const EnergyWeights& weights) {
    const double weight = weights.texel_weight / texture_.NumChannels();
    const int columns = with_warp_ ? texture_.lattice.columns - 1 : 1;
    for (size_t c = 0; c + 1 < bins_.begin.size(); ++c) {
      const size_t n = bins_.begin[c + 1] - bins_.begin[c];
      if (n == 0) continue;
      const int a = static_cast<int>(c) % columns;
      const int b = static_cast<int>(c) / columns;
      const uint32_t* ids = bins_.ids.data() + bins_.begin[c];
      std::vector<double*> parameters = {pose_};
      if (with_warp_) {
        parameters.insert(parameters.end(),
                          {Vertex(a, b),
                           Vertex(a + 1, b),
                           Vertex(a, b + 1),
                           Vertex(a + 1, b + 1)});
      }
      if (texture_.formulation.evaluation == Evaluation::kReference) {
        AddReferenceCell(texture_,
                         state,
                         keyframe,
                         a,
                         b,
                         ids,
                         n,
                         weight,
                         parameters,
                         &ceres_);
        continue;
      }
      for (const PhotoChannel& channel : channels) {
        ceres_.AddResidualBlock(new FrameCellCost(channel.frames[keyframe],
                                                  texture_.origin,
                                                  a,
                                                  b,
                                                  channel.points.data(),
                                                  ids,
                                                  n,
                                                  with_warp_,
                                                  weight),
                                nullptr,
                                parameters);
      }
    }
  }

  void AddWarpTerm(const EnergyWeights& weights) {
    for (int l = 0; l < texture_.lattice.NumVertices(); ++l) {
      ceres_.AddResidualBlock(
          WarpOffsetCost::Create(),
          new ceres::ScaledLoss(
              nullptr, weights.lambda2, ceres::TAKE_OWNERSHIP),
          warp_ + 2 * l);
      if (!(blocks_ & kWarps)) ceres_.SetParameterBlockConstant(warp_ + 2 * l);
    }
  }

  const TextureProblem& texture_;
  unsigned blocks_;
  double* pose_;
  double* warp_;
  bool with_warp_ = false;
  CellBins bins_;
  ceres::Problem ceres_;
};

// Scales the change of pose and warp back to the limits of the configuration.
void LimitFrameStep(const SolverConfig& config,
                    const std::vector<double>& pose_before,
                    const std::vector<double>& warp_before,
                    double* pose,
                    double* warp) {
  const Pose before = PoseFromBlock(pose_before.data());
  const Vector6d xi = LogSe3(PoseFromBlock(pose) * before.Inverse());
  const Pose change = PoseFromBlock(pose) * before.Inverse();
  const Eigen::Vector3d center_shift =
      PoseFromBlock(pose).CenterInSource() - before.CenterInSource();
  double scale = std::max({1.0,
                           RotationAngle(change) / config.max_rotation_rad,
                           center_shift.norm() / config.max_translation_m});
  for (size_t k = 0; k < warp_before.size(); ++k) {
    scale = std::max(scale,
                     std::abs(warp[k] - warp_before[k]) / config.max_warp_px);
  }
  if (!(scale > 1)) return;
  PoseToBlock(ExpSe3(xi / scale) * before, pose);
  for (size_t k = 0; k < warp_before.size(); ++k) {
    warp[k] = warp_before[k] + (warp[k] - warp_before[k]) / scale;
  }
}

// det D > 0.2 in the corners of every cell, hence everywhere: the warp does not
// fold over.
bool WarpIsInvertible(const WarpLattice& lattice, const double* f) {
  const double sx = 1 / lattice.CellWidth(), sy = 1 / lattice.CellHeight();
  for (int row = 0; row + 1 < lattice.rows; ++row) {
    for (int column = 0; column + 1 < lattice.columns; ++column) {
      const double* f00 = f + 2 * lattice.VertexIndex(column, row);
      const double* f10 = f00 + 2;
      const double* f01 = f00 + 2 * lattice.columns;
      const double* f11 = f01 + 2;
      for (int corner = 0; corner < 4; ++corner) {
        const double* low = corner & 1 ? f01 : f00;
        const double* high = corner & 1 ? f11 : f10;
        const double* left = corner & 2 ? f10 : f00;
        const double* below = corner & 2 ? f11 : f01;
        const double dxx = 1 + (high[0] - low[0]) * sx;
        const double dyx = (high[1] - low[1]) * sx;
        const double dxy = (below[0] - left[0]) * sy;
        const double dyy = 1 + (below[1] - left[1]) * sy;
        if (!(dxx * dyy - dxy * dyx > 0.2)) return false;
      }
    }
  }
  return true;
}

struct FrameResult {
  int iterations = 0;
  double cost_before = 0, cost_after = 0;
  bool reverted = false, resting = false;
};

FrameResult SolveFrame(const TextureProblem& problem,
                       const EnergyWeights& weights,
                       const TermBlocks& terms,
                       unsigned blocks,
                       const SolverConfig& config,
                       const std::vector<PhotoChannel>& channels,
                       int keyframe,
                       double* radius,
                       RestMemory* rest,
                       ReconState* state) {
  const size_t num_warp =
      2 * static_cast<size_t>(problem.lattice.NumVertices());
  double* pose = state->poses.data() + kPoseSize * keyframe;
  double* warp = state->warps.data() + num_warp * keyframe;
  const std::vector<double> pose_before(pose, pose + kPoseSize);
  const std::vector<double> warp_before(warp, warp + num_warp);

  FrameProblem frame_problem(
      problem, weights, terms, blocks, channels, keyframe, state);
  const double cost_before = frame_problem.Cost();
  FrameResult result;
  if (Rests(cost_before, config.active_tolerance, rest)) {
    result.cost_before = result.cost_after = 2 * cost_before;
    result.resting = true;
    return result;
  }
  ceres::Solver::Summary solved;
  ceres::Solve(FrameSolverOptions(config, frame_problem.with_warp(), *radius),
               frame_problem.ceres_problem(),
               &solved);
  result.iterations = static_cast<int>(solved.iterations.size());
  result.cost_before = 2 * solved.initial_cost;
  result.cost_after = 2 * solved.final_cost;
  if (!solved.iterations.empty()) {
    *radius =
        std::clamp(solved.iterations.back().trust_region_radius, 1e-2, 1e8);
  }
  LimitFrameStep(config, pose_before, warp_before, pose, warp);
  double cost = frame_problem.Cost();
  if (!(cost <= cost_before) || !WarpIsInvertible(problem.lattice, warp)) {
    std::copy(pose_before.begin(), pose_before.end(), pose);
    std::copy(warp_before.begin(), warp_before.end(), warp);
    cost = cost_before;
    result.reverted = true;
  }
  *rest = RestAfter(solved, cost_before, cost, config.active_tolerance);
  return result;
}

}  // namespace

void SolvePosesAndWarps(const TextureProblem& problem,
                        const EnergyWeights& weights,
                        unsigned blocks,
                        const SolverConfig& config,
                        SolverMemory* memory,
                        ReconState* state,
                        PhaseSummary* summary) {
  const size_t num_frames = static_cast<size_t>(problem.NumKeyframes());
  if (memory->frame_radius.size() != num_frames) {
    memory->frame_radius.assign(num_frames, 1e4);
  }
  std::vector<RestMemory>& rest = memory->frame_rest[blocks == kPoses   ? 0
                                                     : blocks == kWarps ? 1
                                                                        : 2];
  if (rest.size() != num_frames) rest.assign(num_frames, RestMemory());
  const std::vector<PhotoChannel> channels =
      MakePhotoChannels(problem, *state, PointsAt::kPlane);
  const TermBlocks terms(problem, weights);
  std::vector<FrameResult> results(num_frames);
  ParallelFor(0, num_frames, [&](size_t k) {
    const size_t n =
        problem.observations.begin[k + 1] - problem.observations.begin[k];
    if (n < config.min_frame_observations) return;
    const unsigned free =
        config.fix_first_pose && k == 0 ? blocks & ~unsigned{kPoses} : blocks;
    if (free == 0) return;
    results[k] = SolveFrame(problem,
                            weights,
                            terms,
                            free,
                            config,
                            channels,
                            static_cast<int>(k),
                            &memory->frame_radius[k],
                            &rest[k],
                            state);
    problem.ReleaseImages(static_cast<int>(k));
  });
  for (const FrameResult& result : results) {
    summary->problems += result.iterations > 0 ? 1 : 0;
    summary->iterations += result.iterations;
    summary->reverted += result.reverted ? 1 : 0;
    summary->resting += result.resting ? 1 : 0;
    summary->cost_before += result.cost_before;
    summary->cost_after += result.cost_after;
  }
}

}  // namespace facet
