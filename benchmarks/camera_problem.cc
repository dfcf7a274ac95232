// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "benchmarks/camera_problem.h"

#include <ceres/loss_function.h>

#include "costs/frame_cell_cost.h"
#include "costs/warp_offset.h"
#include "problems/reference_blocks.h"

namespace facet {
namespace {

ceres::LossFunction* Scaled(double weight) {
  return new ceres::ScaledLoss(nullptr, weight, ceres::TAKE_OWNERSHIP);
}

}  // namespace

CameraProblem::CameraProblem(const BenchScene& bench,
                             const std::vector<PhotoChannel>& channels,
                             CostForm form,
                             int keyframe,
                             ReconState* state)
    : bins_(BinByCell(bench.scene.problem,
                      channels[0].points,
                      state->CamFromWorld(keyframe),
                      keyframe,
                      false)),
      pose_(state->poses.data() + kPoseSize * keyframe),
      warp_(state->warps.data() +
            2 * static_cast<size_t>(bench.scene.problem.lattice.NumVertices()) *
                keyframe) {
  const TextureProblem& problem = bench.scene.problem;
  ceres_.AddParameterBlock(
      pose_, kPoseSize, CreatePoseManifold(problem.formulation.manifold));
  for (size_t c = 0; c + 1 < bins_.begin.size(); ++c) {
    if (bins_.begin[c + 1] > bins_.begin[c]) {
      AddCell(bench, channels, form, keyframe, c, state);
    }
  }
  for (int l = 0; l < problem.lattice.NumVertices(); ++l) {
    ceres_.AddResidualBlock(
        WarpOffsetCost::Create(), Scaled(bench.weights.lambda2), warp_ + 2 * l);
  }
}

void CameraProblem::AddCell(const BenchScene& bench,
                            const std::vector<PhotoChannel>& channels,
                            CostForm form,
                            int keyframe,
                            size_t cell,
                            ReconState* state) {
  const TextureProblem& problem = bench.scene.problem;
  const int a = static_cast<int>(cell) % (problem.lattice.columns - 1);
  const int b = static_cast<int>(cell) / (problem.lattice.columns - 1);
  const auto vertex = [&](int column, int row) {
    return warp_ + 2 * problem.lattice.VertexIndex(column, row);
  };
  const std::vector<double*> parameters = {pose_,
                                           vertex(a, b),
                                           vertex(a + 1, b),
                                           vertex(a, b + 1),
                                           vertex(a + 1, b + 1)};
  const uint32_t* ids = bins_.ids.data() + bins_.begin[cell];
  const size_t n = bins_.begin[cell + 1] - bins_.begin[cell];
  const double weight = bench.weights.texel_weight / problem.NumChannels();
  if (form == CostForm::kAutodiff) {
    AddReferenceCell(
        problem, *state, keyframe, a, b, ids, n, weight, parameters, &ceres_);
    return;
  }
  for (size_t channel = 0; channel < channels.size(); ++channel) {
    const std::vector<PhotoTexel>& texels = channels[channel].points;
    if (form == CostForm::kCompressed) {
      ceres_.AddResidualBlock(
          new FrameCellCost(channels[channel].frames[keyframe],
                            problem.origin,
                            a,
                            b,
                            texels.data(),
                            ids,
                            n,
                            true,
                            weight),
          nullptr,
          parameters);
      continue;
    }
    views_.push_back(
        {SampledImageOf(problem, static_cast<int>(channel), keyframe),
         problem.camera,
         problem.lattice,
         a,
         b});
    std::vector<ObservedPoint> points;
    for (size_t i = 0; i < n; ++i) {
      const PhotoTexel& t = texels[ids[i]];
      points.push_back(
          {Eigen::Vector3d(t.x, t.y, t.z) + problem.origin, t.color});
    }
    if (form == CostForm::kBatched) {
      // A loss would act on the sum of the rows; scaling commutes with that.
      ceres_.AddResidualBlock(new BatchedCost(views_.back(), std::move(points)),
                              Scaled(weight),
                              parameters);
      continue;
    }
    for (const ObservedPoint& point : points) {
      ceres_.AddResidualBlock(
          new AnalyticCost(views_.back(), point), Scaled(weight), parameters);
    }
  }
}

ceres::Solver::Options CameraSolverOptions(int iterations) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
  options.max_num_iterations = iterations;
  options.function_tolerance = 0;
  options.gradient_tolerance = 0;
  options.parameter_tolerance = 0;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;
  return options;
}

}  // namespace facet
