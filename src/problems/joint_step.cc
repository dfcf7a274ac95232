// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "problems/joint_step.h"

#include <ceres/cost_function.h>
#include <ceres/evaluation_callback.h>
#include <ceres/problem.h>
#include <ceres/sized_cost_function.h>
#include <ceres/solver.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>

#include "costs/plane_manifold.h"
#include "costs/se3_manifold.h"
#include "problems/color_step.h"
#include "problems/gauge.h"
#include "problems/joint_pass.h"
#include "problems/joint_system.h"
#include "problems/term.h"

namespace facet {
namespace {

using RowMajor =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Runs the pass whenever Ceres moves to a new point; the cost functions below
// only read its results. The state is Ceres's parameter memory.
class JointEvaluation : public ceres::EvaluationCallback {
 public:
  JointEvaluation(const TextureProblem& problem,
                  const EnergyWeights& weights,
                  const SolverConfig& config,
                  bool with_planes,
                  const ReconState* state)
      : problem_(problem),
        weights_(weights),
        config_(config),
        own_share_(config.joint_method == JointMethod::kConsensus
                       ? config.joint_own_share
                       : 1.0),
        common_share_(config.joint_method == JointMethod::kFrozen
                          ? 0.0
                          : config.joint_common_share),
        with_planes_(with_planes),
        state_(state) {}

  void PrepareForEvaluation(bool evaluate_jacobians,
                            bool new_evaluation_point) override {
    if (new_evaluation_point) has_pass_ = has_system_ = false;
    // With derivatives even if Ceres asks for the cost of a step alone: it
    // accepts most steps, and then asks for them at the same point.
    if (!has_pass_) RunPass();
    if (evaluate_jacobians && !has_system_) ComputeSystem();
    use_system_ = evaluate_jacobians;
    // An approximate Hessian may explain more than there is: a constant added
    // to the cost keeps the last row real.
    if (reserve_ == 0) reserve_ = cost_ + 10 * system_.explained;
  }

  // E_c at the state of the moment, weighted.
  double InitialCost() const {
    return weights_.texel_weight *
           RunJointPass(problem_, *state_, false, 0).squares;
  }

  double reserve() const { return reserve_; }

  bool use_system() const { return use_system_; }
  const JointSystem& system() const { return system_; }
  // Orthonormal: its transpose turns rows over the tangent into ambient rows,
  // for the manifold of the formulation. (A manifold's own PlusJacobian P would
  // not do: P^T P = I / 4 for the sphere of Ceres 2.1.)
  const PlaneBasis& basis(size_t plane) const { return hessian_basis_[plane]; }
  const PoseLift& lift(size_t keyframe) const { return lift_[keyframe]; }

  double RestResidual() const {
    const double rest =
        cost_ + reserve_ - (use_system_ ? system_.explained : 0.0);
    return rest > 0 ? std::sqrt(rest) : 0.0;
  }

 private:
  void RunPass() {
    pass_ = RunJointPass(problem_, *state_, true, own_share_);
    if (with_planes_) basis_ = pass_.plane_axes;
    // weighted E_c, and with planes lambda1 E_p.
    cost_ = weights_.texel_weight * pass_.squares;
    for (int j = 0; with_planes_ && j < problem_.NumPlanes(); ++j) {
      const Eigen::Map<const Eigen::Vector4d> phi(state_->planes.data() +
                                                  kPlaneSize * j);
      cost_ += weights_.texel_weight * weights_.lambda1 *
               phi.dot(problem_.moments[j] * phi);
    }
    has_pass_ = true;
  }

  void ComputeSystem() {
    lift_.clear();
    for (int k = 0; k < problem_.NumKeyframes(); ++k) {
      lift_.push_back(LeftPoseLift(state_->poses.data() + kPoseSize * k));
    }
    const double weight = weights_.texel_weight;
    const double plane_weight = weight * weights_.lambda1;
    if (num_systems_++ % config_.joint_hessian_every == 0) {
      FactorHessian(weight, plane_weight);
    }
    SetResiduals(problem_,
                 pass_,
                 *state_,
                 hessian_basis_,
                 weight,
                 plane_weight,
                 &system_);
    has_system_ = true;
  }

  void FactorHessian(double weight, double plane_weight) {
    hessian_basis_ = basis_;
    JointHessian hessian =
        config_.joint_method == JointMethod::kExact
            ? ExactHessian(problem_, *state_, basis_, weight)
            : TensorHessian(problem_, pass_, basis_, weight, common_share_);
    LimitPlaneSteps(problem_,
                    pass_,
                    *state_,
                    basis_,
                    weight,
                    plane_weight,
                    config_.max_plane_tilt_rad,
                    config_.max_plane_offset_m,
                    &hessian);
    system_ =
        FactorJointSystem(problem_, std::move(hessian), basis_, plane_weight);
  }

  const TextureProblem& problem_;
  const EnergyWeights& weights_;
  const SolverConfig& config_;
  double own_share_, common_share_;
  bool with_planes_;
  const ReconState* state_;
  double cost_ = 0, reserve_ = 0;
  bool has_pass_ = false, has_system_ = false, use_system_ = false;
  JointPass pass_;
  JointSystem system_;
  std::vector<PlaneBasis> basis_;          // at the point of the moment
  std::vector<PlaneBasis> hessian_basis_;  // of system_
  int num_systems_ = 0;
  std::vector<PoseLift> lift_;
};

// Three rows of R: over one plane and the poses that see it.
class PlaneRowsCost : public ceres::CostFunction {
 public:
  PlaneRowsCost(const JointEvaluation& evaluation, int plane, int num_poses)
      : evaluation_(evaluation), plane_(plane) {
    mutable_parameter_block_sizes()->assign(num_poses + 1, kPoseSize);
    mutable_parameter_block_sizes()->front() = kPlaneSize;
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
    if (!jacobians) return true;
    if (jacobians[0]) {
      Eigen::Map<Eigen::Matrix<double, 3, 4, Eigen::RowMajor>> j(jacobians[0]);
      j = rows.diagonal * evaluation_.basis(plane_).transpose();
    }
    for (size_t a = 0; a < rows.keyframes.size(); ++a) {
      if (!jacobians[a + 1]) continue;
      Eigen::Map<Eigen::Matrix<double, 3, kPoseSize, Eigen::RowMajor>> j(
          jacobians[a + 1]);
      j = rows.poses.middleCols<6>(6 * static_cast<Eigen::Index>(a)) *
          evaluation_.lift(rows.keyframes[a]);
    }
    return true;
  }

 private:
  const JointEvaluation& evaluation_;
  int plane_;
};

// Six rows of R: over one pose and all later ones.
class PoseRowsCost : public ceres::CostFunction {
 public:
  PoseRowsCost(const JointEvaluation& evaluation, int keyframe, int num_poses)
      : evaluation_(evaluation), keyframe_(keyframe) {
    mutable_parameter_block_sizes()->assign(num_poses - keyframe, kPoseSize);
    set_num_residuals(6);
  }

  bool Evaluate(double const* const*,
                double* residuals,
                double** jacobians) const override {
    Eigen::Map<Vector6d> r(residuals);
    r.setZero();
    if (!evaluation_.use_system()) return true;
    const JointSystem& system = evaluation_.system();
    r = system.pose_residual.segment<6>(6 * keyframe_);
    if (!jacobians) return true;
    for (size_t a = 0; a < parameter_block_sizes().size(); ++a) {
      if (!jacobians[a]) continue;
      const int other = keyframe_ + static_cast<int>(a);
      Eigen::Map<Eigen::Matrix<double, 6, kPoseSize, Eigen::RowMajor>> j(
          jacobians[a]);
      j = system.poses.block<6, 6>(6 * keyframe_, 6 * other) *
          evaluation_.lift(other);
    }
    return true;
  }

 private:
  const JointEvaluation& evaluation_;
  int keyframe_;
};

// What the rows do not explain: keeps the cost exact.
class RestCost : public ceres::SizedCostFunction<1, kPoseSize> {
 public:
  explicit RestCost(const JointEvaluation& evaluation)
      : evaluation_(evaluation) {}

  bool Evaluate(double const* const*,
                double* residuals,
                double** jacobians) const override {
    residuals[0] = evaluation_.RestResidual();
    if (jacobians && jacobians[0]) {
      std::fill(jacobians[0], jacobians[0] + kPoseSize, 0.0);
    }
    return true;
  }

 private:
  const JointEvaluation& evaluation_;
};

void AddBlocks(const TextureProblem& problem,
               const EnergyWeights& weights,
               const JointEvaluation& evaluation,
               bool with_planes,
               bool hold_common_motion,
               ReconState* state,
               ceres::Problem* ceres_problem) {
  const int num_keyframes = problem.NumKeyframes();
  const auto pose = [&](int k) { return state->poses.data() + kPoseSize * k; };
  for (int k = 0; k < num_keyframes; ++k) {
    std::vector<double*> parameters;
    for (int other = k; other < num_keyframes; ++other) {
      parameters.push_back(pose(other));
    }
    ceres_problem->AddResidualBlock(
        new PoseRowsCost(evaluation, k, num_keyframes), nullptr, parameters);
    ceres_problem->SetManifold(
        pose(k), CreatePoseManifold(problem.formulation.manifold));
  }
  // On a pose that moves: Ceres evaluates residuals of constant blocks once.
  ceres_problem->AddResidualBlock(
      new RestCost(evaluation), nullptr, pose(num_keyframes - 1));
  if (hold_common_motion) {
    AddCommonMotionCost(
        problem, evaluation.InitialCost(), state, ceres_problem);
  }
  for (int j = 0; with_planes && j < problem.NumPlanes(); ++j) {
    const std::vector<int> keyframes = KeyframesOfPlane(problem, j);
    if (keyframes.empty()) continue;
    double* plane = state->planes.data() + kPlaneSize * j;
    std::vector<double*> parameters = {plane};
    for (const int k : keyframes) parameters.push_back(pose(k));
    ceres_problem->AddResidualBlock(
        new PlaneRowsCost(evaluation, j, static_cast<int>(keyframes.size())),
        nullptr,
        parameters);
    ceres_problem->SetManifold(
        plane,
        CreatePlaneManifold(problem.formulation.plane, problem.anchors[j]));
  }
  TermBlocks(problem, weights).AddAll(state, ceres_problem);
}

}  // namespace

void SolveJoint(const TextureProblem& problem,
                const EnergyWeights& weights,
                unsigned blocks,
                const SolverConfig& config,
                SolverMemory* memory,
                ReconState* state,
                PhaseSummary* summary) {
  const bool with_planes = (blocks & kPlanes) != 0;
  JointEvaluation evaluation(problem, weights, config, with_planes, state);
  ceres::Problem::Options problem_options;
  problem_options.evaluation_callback = &evaluation;
  ceres::Problem ceres_problem(problem_options);
  AddBlocks(problem,
            weights,
            evaluation,
            with_planes,
            config.remove_common_motion,
            state,
            &ceres_problem);
  if (config.fix_first_pose) {
    ceres_problem.SetParameterBlockConstant(state->poses.data());
  }

  ceres::Solver::Options options;
  // R is dense in the poses; planes first costs no fill.
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
  options.function_tolerance = 1e-9;  // of a cost with the reserve in it
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
  SolveColors(problem, state);
}

}  // namespace facet
