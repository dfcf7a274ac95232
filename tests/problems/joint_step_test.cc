// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "costs/plane_manifold.h"
#include "costs/se3_manifold.h"
#include "problems/color_step.h"
#include "problems/gauge.h"
#include "problems/joint_pass.h"
#include "problems/joint_system.h"
#include "problems/solve_blocks.h"
#include "tests/support/tiny_scene.h"

namespace facet {
namespace {

constexpr unsigned kJoint = kColors | kPoses;

class JointStep : public testing::Test {
 protected:
  JointStep() : scene_(MakeTinyScene()), state_(scene_.truth) {
    CutIntoStrips(8);
    PerturbPoses(0.003, 0.004, 1, &state_);
    PerturbPlanes(0.003, 0.003, 2, &state_);
    weights_ = StartFrom(&state_, &scene_.problem);
  }

  // Tiles short enough for viewing directions to be nearly constant on them.
  void CutIntoStrips(size_t texels) {
    std::vector<TexelTile> strips;
    for (const TexelTile& tile : scene_.problem.tiles) {
      for (size_t i = tile.texel_begin; i < tile.texel_end; i += texels) {
        strips.push_back(
            {tile.plane, i, std::min(i + texels, tile.texel_end), 0, 0});
      }
    }
    scene_.problem.tiles = strips;
    FinishTextureProblem(&scene_.problem);
  }

  std::vector<Eigen::Matrix<double, 4, 3>> PlaneBases() const {
    std::vector<Eigen::Matrix<double, 4, 3>> bases;
    for (int j = 0; j < scene_.problem.NumPlanes(); ++j) {
      Eigen::Matrix<double, 4, 3, Eigen::RowMajor> p;
      AnchoredPlaneManifold().PlusJacobian(
          state_.planes.data() + kPlaneSize * j, p.data());
      bases.push_back(p);
    }
    return bases;
  }

  TinyScene scene_;
  ReconState state_;
  EnergyWeights weights_;
};

// Breaks when a view's force, moment or plane row has a wrong sign or frame, or
// when colours are not re-averaged (the mean's own derivative cancels).
TEST_F(JointStep, GradientIsThatOfTheReaveragedCost) {
  const JointPass pass = RunJointPass(scene_.problem, state_, true, 0.1);
  const auto squares = [&](const ReconState& s) {
    return RunJointPass(scene_.problem, s, false, 0).squares;
  };
  const double h = 2e-5;
  Eigen::VectorXd analytic, numeric;
  const auto compare = [&](double a, double n) {
    analytic.conservativeResize(analytic.size() + 1);
    numeric.conservativeResize(numeric.size() + 1);
    analytic[analytic.size() - 1] = a;
    numeric[numeric.size() - 1] = n;
  };
  for (int k = 0; k < scene_.problem.NumKeyframes(); ++k) {
    for (int i = 0; i < 6; ++i) {
      double value[2];
      for (int side = 0; side < 2; ++side) {
        ReconState moved = state_;
        Vector6d xi = Vector6d::Zero();
        xi[i] = side == 0 ? h : -h;
        LeftSe3Manifold().Plus(state_.poses.data() + kPoseSize * k,
                               xi.data(),
                               moved.poses.data() + kPoseSize * k);
        value[side] = squares(moved);
      }
      compare(2 * pass.pose_gradient[k][i], (value[0] - value[1]) / (2 * h));
    }
  }
  const auto bases = PlaneBases();
  for (int j = 0; j < scene_.problem.NumPlanes(); ++j) {
    const Eigen::Vector3d tangent =
        bases[j].transpose() * pass.plane_gradient[j];
    for (int i = 0; i < 3; ++i) {
      double value[2];
      for (int side = 0; side < 2; ++side) {
        ReconState moved = state_;
        Eigen::Vector3d delta = Eigen::Vector3d::Zero();
        delta[i] = side == 0 ? h : -h;
        AnchoredPlaneManifold().Plus(state_.planes.data() + kPlaneSize * j,
                                     delta.data(),
                                     moved.planes.data() + kPlaneSize * j);
        value[side] = squares(moved);
      }
      compare(2 * tangent[i], (value[0] - value[1]) / (2 * h));
    }
  }
  // Bilinear kinks: about 1 % on single entries.
  EXPECT_LT((analytic - numeric).norm(), 0.02 * numeric.norm())
      << "analytic " << analytic.transpose() << "\nnumeric "
      << numeric.transpose();
}

// Breaks when blocks of R belong to other columns than those of the gradient,
// or planes are eliminated wrongly: R^T r' must give the gradient back,
// whatever the Hessian, so that all methods descend on the same cost.
TEST_F(JointStep, FactorKeepsTheGradientOfEveryHessian) {
  const TextureProblem& problem = scene_.problem;
  const JointPass pass = RunJointPass(problem, state_, true, 0.1);
  const auto bases = PlaneBases();
  for (const JointHessian& hessian :
       {TensorHessian(problem, pass, bases, 4.0, 0.99),
        TensorHessian(problem, pass, bases, 4.0, 0.0),
        ExactHessian(problem, state_, bases, 4.0)}) {
    JointSystem system = FactorJointSystem(problem, hessian, bases, 3.0);
    SetResiduals(GradientOf(problem, pass, state_, 4.0, 3.0), bases, &system);
    Eigen::VectorXd poses =
        system.poses.triangularView<Eigen::Upper>().transpose() *
        system.pose_residual;
    double explained = system.pose_residual.squaredNorm();
    for (size_t j = 0; j < system.planes.size(); ++j) {
      const JointPlaneRows& rows = system.planes[j];
      explained += rows.residual.squaredNorm();
      for (size_t a = 0; a < rows.keyframes.size(); ++a) {
        poses.segment<6>(6 * rows.keyframes[a]) +=
            rows.poses.middleCols<6>(6 * a).transpose() * rows.residual;
      }
      const Eigen::Vector3d g = rows.diagonal.transpose() * rows.residual;
      const Eigen::Map<const Eigen::Vector4d> phi(state_.planes.data() +
                                                  kPlaneSize * j);
      const Eigen::Vector3d expected =
          bases[j].transpose() *
          (4.0 * pass.plane_gradient[j] + 3.0 * problem.moments[j] * phi);
      EXPECT_LT((g - expected).norm(), 1e-8 * (1 + expected.norm()));
    }
    for (size_t k = 0; k < pass.pose_gradient.size(); ++k) {
      EXPECT_LT((poses.segment<6>(6 * k) - 4.0 * pass.pose_gradient[k]).norm(),
                1e-7 * (1 + pass.pose_gradient[k].norm()));
    }
    EXPECT_NEAR(explained, system.explained, 1e-9 * explained);
  }
}

// Breaks when the step does not go downhill or the trust region gets a cost
// that is not that of the state.
TEST_F(JointStep, OnePhaseLowersTheObjectiveMoreThanAnAlternationRound) {
  const EnergyTerms before = EvaluateEnergy(scene_.problem, weights_, state_);
  SolverConfig config;
  config.remove_common_motion = false;
  SolverMemory memory;
  ReconState joint = state_;
  const PhaseSummary summary = SolveBlocks(
      scene_.problem, weights_, kJoint, config, before, &memory, &joint);
  EXPECT_TRUE(summary.accepted);
  ReconState alternating = state_;
  EnergyTerms current = before;
  for (const unsigned blocks : {kColors, kPoses, kColors}) {
    current = SolveBlocks(scene_.problem,
                          weights_,
                          blocks,
                          config,
                          current,
                          &memory,
                          &alternating)
                  .after;
  }
  EXPECT_LT(summary.after.Objective(), current.Objective());
}

// Breaks when the tolerance is not of the objective, or when the step that ends
// a solve is given back: solves of 1, 2, ... iterations say where the end is.
TEST_F(JointStep, EndsAfterAStepOfLittleGainAndKeepsIt) {
  constexpr double kTolerance = 2e-3;
  const EnergyTerms before = EvaluateEnergy(scene_.problem, weights_, state_);
  const auto solve = [&](int max_iterations, double tolerance) {
    SolverConfig config;
    config.remove_common_motion = false;
    config.max_joint_iterations = max_iterations;
    config.joint_tolerance = tolerance;
    SolverMemory memory;
    ReconState joint = state_;
    return SolveBlocks(scene_.problem,
                       weights_,
                       kJoint | kPlanes,  // the whole objective
                       config,
                       before,
                       &memory,
                       &joint);
  };
  double last = before.Objective();
  double end = last;
  for (int n = 1; n <= 20; ++n) {
    end = solve(n, 0).after.Objective();
    if (end < last && last - end < kTolerance * end) break;
    last = end;
  }
  ASSERT_LT(last - end, kTolerance * end) << "never gains little";
  const PhaseSummary ended = solve(20, kTolerance);
  EXPECT_LT(ended.iterations, 20);
  EXPECT_NEAR(ended.after.Objective(), end, 1e-9 * end);
}

// A Hessian that is kept for the whole solve changes the way, not the descent:
// the gradient is that of every point. Breaks if residuals are kept with it.
TEST_F(JointStep, AnOldHessianComesToTheSameEnergy) {
  const EnergyTerms before = EvaluateEnergy(scene_.problem, weights_, state_);
  double objective[2];
  for (const int every : {1, 1000}) {
    SolverConfig config;
    config.remove_common_motion = false;
    config.joint_hessian_every = every;
    config.max_joint_iterations = 15;
    SolverMemory memory;
    ReconState joint = state_;
    const PhaseSummary summary = SolveBlocks(scene_.problem,
                                             weights_,
                                             kJoint | kPlanes,
                                             config,
                                             before,
                                             &memory,
                                             &joint);
    EXPECT_TRUE(summary.accepted);
    objective[every > 1] = summary.after.Objective();
  }
  const double gain = before.Objective() - objective[0];
  EXPECT_GT(gain, 0.1 * before.Objective());
  EXPECT_NEAR(objective[1], objective[0], 0.02 * gain);
}

// Breaks when the joint solve stops at a wrong point.
TEST_F(JointStep, RecoversPoses) {
  state_ = scene_.truth;
  PerturbPoses(0.003, 0.004, 1, &state_);
  weights_ = StartFrom(&state_, &scene_.problem);
  weights_.pose_prior = false;
  SolverConfig config;
  config.remove_common_motion = false;
  SolverMemory memory;
  const StateError start = CompareToTruth(scene_, state_);
  EnergyTerms current = EvaluateEnergy(scene_.problem, weights_, state_);
  for (int round = 0; round < 4; ++round) {
    current =
        SolveBlocks(
            scene_.problem, weights_, kJoint, config, current, &memory, &state_)
            .after;
  }
  const StateError end = CompareToTruth(scene_, state_);
  EXPECT_LT(end.rotation_rad, 0.1 * start.rotation_rad);
  EXPECT_LT(end.center_m, 0.25 * start.center_m);
}

// Breaks when the gauge leaves a common motion in, or moves cameras against
// each other.
TEST_F(JointStep, GaugeTakesOutTheCommonMotionAlone) {
  const std::vector<Pose>& initial = scene_.problem.initial_cam_from_world;
  Vector6d xi;
  xi << 0.01, -0.02, 0.015, 0.05, 0.02, -0.03;
  const Pose motion = ExpSe3(xi);
  ReconState moved = state_;
  for (size_t k = 0; k < initial.size(); ++k) {
    PoseToBlock(initial[k] * motion, moved.poses.data() + kPoseSize * k);
  }
  RemoveCommonMotion(scene_.problem, &moved);
  for (size_t k = 0; k < initial.size(); ++k) {
    const Pose left =
        moved.CamFromWorld(static_cast<int>(k)) * initial[k].Inverse();
    EXPECT_LT(LogSe3(left).norm(), 1e-6);
  }
}

// Breaks when a row of the mean motion has a wrong sign or arm.
TEST_F(JointStep, CommonMotionCostHasItsDerivative) {
  const std::vector<Pose>& initial = scene_.problem.initial_cam_from_world;
  const std::unique_ptr<ceres::CostFunction> cost(
      CreateCommonMotionCost(initial, 2.0));
  PerturbPoses(0.01, 0.02, 5, &state_);
  const int n = scene_.problem.NumKeyframes();
  const auto residual = [&](const ReconState& s, double** jacobians) {
    std::vector<const double*> parameters;
    for (int k = 0; k < n; ++k) {
      parameters.push_back(s.poses.data() + kPoseSize * k);
    }
    Vector6d r;
    EXPECT_TRUE(cost->Evaluate(parameters.data(), r.data(), jacobians));
    return r;
  };
  std::vector<std::vector<double>> storage(n, std::vector<double>(42));
  std::vector<double*> jacobians;
  for (auto& s : storage) jacobians.push_back(s.data());
  residual(state_, jacobians.data());
  const double h = 1e-6;
  for (int k = 0; k < n; ++k) {
    double* block = state_.poses.data() + kPoseSize * k;
    Eigen::Matrix<double, 7, 6, Eigen::RowMajor> plus;
    LeftSe3Manifold().PlusJacobian(block, plus.data());
    const Eigen::Matrix<double, 6, 6> analytic =
        Eigen::Map<Eigen::Matrix<double, 6, 7, Eigen::RowMajor>>(
            storage[k].data()) *
        plus;
    for (int i = 0; i < 6; ++i) {
      Vector6d value[2];
      for (int side = 0; side < 2; ++side) {
        ReconState moved = state_;
        Vector6d xi = Vector6d::Zero();
        xi[i] = side == 0 ? h : -h;
        LeftSe3Manifold().Plus(
            block, xi.data(), moved.poses.data() + kPoseSize * k);
        value[side] = residual(moved, nullptr);
      }
      EXPECT_LT((analytic.col(i) - (value[0] - value[1]) / (2 * h)).norm(),
                1e-6);
    }
  }
}

}  // namespace
}  // namespace facet
