// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "problems/joint_step.h"

#include <ceres/cost_function.h>
#include <ceres/problem.h>
#include <ceres/sized_cost_function.h>
#include <ceres/solver.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>

#include "problems/color_step.h"
#include "problems/joint_coordinates.h"
#include "problems/joint_evaluation.h"

namespace facet {
namespace {

using RowMajorX =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Three rows of R: over the offset of one plane.
class PlaneRowsCost : public ceres::CostFunction {
 public:
  PlaneRowsCost(const JointEvaluation& evaluation, int plane)
      : evaluation_(evaluation), plane_(plane) {
    mutable_parameter_block_sizes()->push_back(
        evaluation.coordinates().plane_size());
    set_num_residuals(3);
  }

  bool Evaluate(double const* const*,
                double* residuals,
                double** jacobians) const override {
    Eigen::Map<Eigen::Vector3d> r(residuals);
    r.setZero();
    if (!evaluation_.use_system()) return true;
    const JointPlaneRows& rows = evaluation_.system().planes[plane_];
    r = rows.residual;
    if (!jacobians || !jacobians[0]) return true;
    Eigen::Map<RowMajorX> j(jacobians[0], 3, parameter_block_sizes()[0]);
    j = rows.diagonal * evaluation_.coordinates().BasisFromPlane(plane_);
    return true;
  }

 private:
  const JointEvaluation& evaluation_;
  int plane_;
};

class PoseRowsCost : public ceres::CostFunction {
 public:
  PoseRowsCost(const JointEvaluation& evaluation, int keyframe, int num_poses)
      : evaluation_(evaluation), keyframe_(keyframe) {
    mutable_parameter_block_sizes()->assign(num_poses - keyframe, 6);
    set_num_residuals(6);
  }

  bool Evaluate(double const* const*,
                double* residuals,
                double** jacobians) const override {
    Eigen::Map<Vector6d> r(residuals);
    r.setZero();
    if (!evaluation_.use_system()) return true;
    r = evaluation_.system().pose_residual.segment<6>(6 * keyframe_);
    if (!jacobians) return true;
    const double* cell = evaluation_.PoseRows(keyframe_);
    for (size_t a = 0; a < parameter_block_sizes().size(); ++a) {
      if (jacobians[a]) {
        std::copy(cell, cell + JointEvaluation::kCell, jacobians[a]);
      }
      cell += JointEvaluation::kCell;
    }
    return true;
  }

 private:
  const JointEvaluation& evaluation_;
  int keyframe_;
};

// What the rows do not explain: keeps the cost exact.
class RestCost : public ceres::SizedCostFunction<1, 6> {
 public:
  explicit RestCost(const JointEvaluation& evaluation)
      : evaluation_(evaluation) {}

  bool Evaluate(double const* const*,
                double* residuals,
                double** jacobians) const override {
    if (!evaluation_.valid()) return false;
    residuals[0] = evaluation_.RestResidual();
    if (jacobians && jacobians[0]) {
      std::fill(jacobians[0], jacobians[0] + 6, 0.0);
    }
    return true;
  }

 private:
  const JointEvaluation& evaluation_;
};

void AddBlocks(const TextureProblem& problem,
               const JointEvaluation& evaluation,
               JointCoordinates* coordinates,
               ceres::Problem* ceres_problem) {
  const int num_keyframes = problem.NumKeyframes();
  for (int k = 0; k < num_keyframes; ++k) {
    std::vector<double*> parameters;
    for (int other = k; other < num_keyframes; ++other) {
      parameters.push_back(coordinates->pose(other));
    }
    ceres_problem->AddResidualBlock(
        new PoseRowsCost(evaluation, k, num_keyframes), nullptr, parameters);
  }
  // On a pose that moves: Ceres evaluates residuals of constant blocks once.
  ceres_problem->AddResidualBlock(
      new RestCost(evaluation), nullptr, coordinates->pose(num_keyframes - 1));
  for (int j = 0; coordinates->with_planes() && j < problem.NumPlanes(); ++j) {
    ceres_problem->AddResidualBlock(
        new PlaneRowsCost(evaluation, j), nullptr, coordinates->plane(j));
  }
}

// Ends the solve after a step that changed the objective by less than a share,
// or would have: refused. (Ceres's own tolerance is of a cost with the reserve
// in it, and would drop a step that was accepted.)
class EndOfGain : public ceres::IterationCallback {
 public:
  EndOfGain(const JointEvaluation& evaluation, double tolerance)
      : evaluation_(evaluation), tolerance_(tolerance) {}

  ceres::CallbackReturnType operator()(
      const ceres::IterationSummary& step) override {
    const double objective = step.cost - 0.5 * evaluation_.reserve();
    return step.iteration > 0 && step.step_is_valid &&
                   std::abs(step.cost_change) < tolerance_ * objective
               ? ceres::SOLVER_TERMINATE_SUCCESSFULLY
               : ceres::SOLVER_CONTINUE;
  }

 private:
  const JointEvaluation& evaluation_;
  double tolerance_;
};

}  // namespace

void SolveJoint(const TextureProblem& problem,
                const EnergyWeights& weights,
                unsigned blocks,
                const SolverConfig& config,
                SolverMemory* memory,
                ReconState* state,
                PhaseSummary* summary) {
  const ReconState start = *state;
  JointCoordinates coordinates(problem, (blocks & kPlanes) != 0, state);
  JointEvaluation evaluation(problem, weights, config, state, &coordinates);
  ceres::Problem::Options problem_options;
  problem_options.evaluation_callback = &evaluation;
  ceres::Problem ceres_problem(problem_options);
  AddBlocks(problem, evaluation, &coordinates, &ceres_problem);
  if (config.fix_first_pose) {
    ceres_problem.SetParameterBlockConstant(coordinates.pose(0));
  }

  ceres::Solver::Options options;
  options.linear_solver_type =
      config.joint_linear_solver == JointLinearSolver::kCgnr
          ? ceres::CGNR
          : ceres::SPARSE_NORMAL_CHOLESKY;
  options.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
  // Conjugate gradients end at iteration k when it added less than eta / k of
  // the decrease so far. The soft common modes add little to the model's cost
  // and come last: with Ceres's 0.1 they are left out after two iterations.
  options.eta = 2e-3;
  options.max_num_iterations = config.max_joint_iterations;
  options.initial_trust_region_radius = memory->joint_radius;
  options.max_trust_region_radius = config.max_joint_radius;
  options.logging_type = ceres::SILENT;
  options.num_threads = 1;  // the pass is parallel itself, in fixed order
  EndOfGain end_of_gain(evaluation, config.joint_tolerance);
  options.callbacks.push_back(&end_of_gain);
  options.function_tolerance = 0;
  ceres::Solver::Summary solved;
  ceres::Solve(options, &ceres_problem, &solved);
  VLOG(2) << solved.FullReport();
  for (const ceres::IterationSummary& it : solved.iterations) {
    VLOG(1) << "joint: cost " << it.cost - 0.5 * evaluation.reserve()
            << " change " << it.cost_change << " rho " << it.relative_decrease
            << " radius " << it.trust_region_radius << " linear iterations "
            << it.linear_solver_iterations << " valid " << it.step_is_valid
            << " accepted " << it.step_is_successful;
  }
  summary->problems = 1;
  summary->iterations = static_cast<int>(solved.iterations.size());
  summary->cost_before = 2 * solved.initial_cost - evaluation.reserve();
  summary->cost_after = 2 * solved.final_cost - evaluation.reserve();
  if (!solved.iterations.empty()) {
    memory->joint_radius =
        std::clamp(solved.iterations.back().trust_region_radius,
                   1.0,
                   config.max_joint_radius);
  }
  if (solved.IsSolutionUsable()) {
    CHECK(coordinates.Place()) << "the point was evaluated before";
  } else {
    state->poses = start.poses;
    state->planes = start.planes;
  }
  SolveColors(problem, state);
}

}  // namespace facet
