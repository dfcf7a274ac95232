// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The methods of the joint solve against each other and against the plain
// problem with a residual an observation.
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>

#include "costs/plane_manifold.h"
#include "costs/se3_manifold.h"
#include "problems/explicit_problem.h"
#include "problems/gauge.h"
#include "problems/joint_hessian.h"
#include "problems/solve_blocks.h"
#include "tests/support/tiny_scene.h"

namespace facet {
namespace {

constexpr unsigned kAll = kColors | kPlanes | kPoses;

// A corner of a room with poses and planes displaced, colours at their optimum.
class JointMethods : public testing::Test {
 protected:
  JointMethods() {
    TinySceneOptions options;
    options.texel_spacing_m = 0.08;
    options.keyframes = 6;
    scene_ = MakeTinyScene(options);
    // Tiles short enough for viewing directions to be nearly constant on them.
    TextureProblem& p = scene_.problem;
    std::vector<TexelTile> strips;
    for (const TexelTile& tile : p.tiles) {
      for (size_t i = tile.texel_begin; i < tile.texel_end; i += 6) {
        strips.push_back(
            {tile.plane, i, std::min(i + 6, tile.texel_end), 0, 0});
      }
    }
    p.tiles = strips;
    FinishTextureProblem(&p);
    state_ = scene_.truth;
    PerturbPoses(0.002, 0.003, 1, &state_);
    PerturbPlanes(0.002, 0.002, 2, &state_);
    weights_ = StartFrom(&state_, &p);
    config_.remove_common_motion = false;
    config_.min_frame_observations = 0;
  }

  std::vector<PlaneBasis> Bases() const {
    std::vector<PlaneBasis> bases;
    for (int j = 0; j < scene_.problem.NumPlanes(); ++j) {
      Eigen::Matrix<double, 4, 3, Eigen::RowMajor> p;
      AnchoredPlaneManifold().PlusJacobian(
          state_.planes.data() + kPlaneSize * j, p.data());
      bases.push_back(p);
    }
    return bases;
  }

  // H of poses, then planes, symmetric.
  static Eigen::MatrixXd Dense(const JointHessian& h) {
    const Eigen::Index n = h.poses.rows();
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(
        n + 3 * static_cast<Eigen::Index>(h.planes.size()),
        n + 3 * static_cast<Eigen::Index>(h.planes.size()));
    all.topLeftCorner(n, n) = h.poses;
    for (size_t j = 0; j < h.planes.size(); ++j) {
      const Eigen::Index at = n + 3 * static_cast<Eigen::Index>(j);
      all.block<3, 3>(at, at) = h.planes[j].plane;
      for (size_t a = 0; a < h.planes[j].keyframes.size(); ++a) {
        all.block<6, 3>(6 * h.planes[j].keyframes[a], at) =
            h.planes[j]
                .poses.middleCols<6>(6 * static_cast<Eigen::Index>(a))
                .transpose();
      }
    }
    return all.selfadjointView<Eigen::Upper>();
  }

  PhaseSummary Solve(JointMethod method, unsigned blocks, int iterations) {
    SolverConfig config = config_;
    config.joint_method = method;
    config.max_joint_iterations = iterations;
    return SolveBlocks(scene_.problem,
                       weights_,
                       blocks,
                       config,
                       EvaluateEnergy(scene_.problem, weights_, state_),
                       &memory_,
                       &state_);
  }

  TinyScene scene_;
  ReconState state_;
  EnergyWeights weights_;
  SolverConfig config_;
  SolverMemory memory_;
};

// The exact Hessian is the Schur complement of the colours in J^T J of the
// plain problem. Breaks if a row has a wrong arm or sign, a mean is not taken
// out, or blocks end up at another keyframe or plane.
TEST_F(JointMethods, ExactHessianIsTheSchurComplementOfTheColours) {
  const TextureProblem& p = scene_.problem;
  const Eigen::MatrixXd found =
      Dense(ExactHessian(p, state_, Bases(), weights_.texel_weight));
  EnergyWeights only_e_c = weights_;
  only_e_c.lambda1 = 0;
  only_e_c.pose_prior = false;
  ReconState state = state_;
  ExplicitProblem plain(p, only_e_c, &state);
  ceres::Problem::EvaluateOptions options;
  for (int k = 0; k < p.NumKeyframes(); ++k) {
    options.parameter_blocks.push_back(state.poses.data() + kPoseSize * k);
  }
  for (int j = 0; j < p.NumPlanes(); ++j) {
    options.parameter_blocks.push_back(state.planes.data() + kPlaneSize * j);
  }
  for (size_t i = 0; i < plain.colors().size(); ++i) {
    if (p.views[i] == 0) continue;
    options.parameter_blocks.push_back(
        const_cast<double*>(plain.colors().data()) + i);
  }
  ceres::CRSMatrix sparse;
  plain.ceres_problem()->Evaluate(options, nullptr, nullptr, nullptr, &sparse);
  Eigen::MatrixXd j = Eigen::MatrixXd::Zero(sparse.num_rows, sparse.num_cols);
  for (int row = 0; row < sparse.num_rows; ++row) {
    for (int i = sparse.rows[row]; i < sparse.rows[row + 1]; ++i) {
      j(row, sparse.cols[i]) = sparse.values[i];
    }
  }
  const Eigen::Index n = found.rows();
  const Eigen::MatrixXd h = j.transpose() * j;
  const Eigen::MatrixXd h_cc = h.bottomRightCorner(h.rows() - n, h.cols() - n);
  const Eigen::MatrixXd h_cb = h.bottomLeftCorner(h.rows() - n, n);
  const Eigen::MatrixXd expected =
      h.topLeftCorner(n, n) -
      h_cb.transpose() * h_cc.diagonal().cwiseInverse().asDiagonal() * h_cb;
  EXPECT_LT((found - expected).norm(), 1e-4 * expected.norm());
}

// At the truth, where all views agree, the tensors are good. Breaks if a row of
// a view has a wrong arm, or a plane column the sign of a shift to the other
// side.
TEST_F(JointMethods, TensorHessiansAreLikeTheExactOneAtTheTruth) {
  const TextureProblem& p = scene_.problem;
  state_ = scene_.truth;
  const std::vector<PlaneBasis> bases = Bases();
  const Eigen::MatrixXd exact = Dense(ExactHessian(p, state_, bases, 1.0));
  const Eigen::VectorXd scale = exact.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled =
      scale.asDiagonal() * exact * scale.asDiagonal();
  for (const double own_share : {0.0, 1.0}) {
    const Eigen::MatrixXd tensor = Dense(TensorHessian(
        p, RunJointPass(p, state_, true, own_share), bases, 1.0, 1.0));
    const Eigen::MatrixXd difference =
        scale.asDiagonal() * tensor * scale.asDiagonal() - scaled;
    EXPECT_LT(difference.norm(), 0.5 * scaled.norm()) << own_share;
  }
}

// Breaks if the tilt of a plane no larger than a tile has no curvature.
TEST_F(JointMethods, PlanesOfOneTileHaveTheirCurvature) {
  TextureProblem& p = scene_.problem;
  p.tiles.clear();
  FinishTextureProblem(&p);
  ASSERT_EQ(p.tiles.size(), static_cast<size_t>(p.NumPlanes()));
  state_ = scene_.truth;
  const std::vector<PlaneBasis> bases = Bases();
  const JointHessian exact = ExactHessian(p, state_, bases, 1.0);
  const JointHessian tensor =
      TensorHessian(p, RunJointPass(p, state_, true, 0.1), bases, 1.0, 1.0);
  for (int j = 0; j < p.NumPlanes(); ++j) {
    for (int i = 0; i < 3; ++i) {
      const double ratio =
          tensor.planes[j].plane(i, i) / exact.planes[j].plane(i, i);
      EXPECT_GT(ratio, 0.3) << j << " " << i;
      EXPECT_LT(ratio, 3) << j << " " << i;
    }
  }
}

// A plane that the energy hardly knows must not turn over, nor hold up the
// others. Breaks without the stiffness of the limits.
TEST_F(JointMethods, NarrowPlanesKeepTheLimits) {
  TextureProblem& p = scene_.problem;
  // All texels of plane 0 are drawn to one line through its anchor.
  const Eigen::Vector3d line =
      scene_.planes[0].normal.unitOrthogonal().normalized();
  for (size_t i = 0; i < p.texels.size(); ++i) {
    if (p.texels.plane[i] != 0) continue;
    const Eigen::Vector3d arm =
        p.texels.position[i].cast<double>() - p.anchors[0];
    p.texels.position[i] =
        (p.anchors[0] + line.dot(arm) * line +
         1e-4 * (i % 7) * scene_.planes[0].normal.cross(line) +
         1e-3 * (i % 5) * scene_.planes[0].normal)
            .cast<float>();
  }
  FinishTextureProblem(&p);
  weights_ = StartFrom(&state_, &p);
  const ReconState start = state_;
  memory_ = SolverMemory();
  const PhaseSummary summary = Solve(JointMethod::kConsensus, kAll, 1);
  EXPECT_TRUE(summary.accepted);
  EXPECT_LT(summary.after.Objective(), 0.8 * summary.before.Objective());
  const Eigen::Map<const Eigen::Vector3d> a(start.planes.data());
  const Eigen::Map<const Eigen::Vector3d> b(state_.planes.data());
  EXPECT_LT(a.cross(b).norm(), 1.5 * config_.max_plane_tilt_rad);
  EXPECT_GT(a.dot(b), 0);
}

// Breaks if a method stops elsewhere, forgets a term or a block, or if rows
// over the tangent of a plane are not those that Ceres's manifold stands for
// (the model is then wrong and most steps fail).
TEST_F(JointMethods, ReachTheEnergyOfThePlainProblem) {
  const ReconState start = state_;
  const double expected =
      Solve(JointMethod::kSchur, kAll, 10).after.Objective();
  for (const JointMethod method : {JointMethod::kConsensus,
                                   JointMethod::kExact,
                                   JointMethod::kFrameTensors,
                                   JointMethod::kInner}) {
    state_ = start;
    memory_ = SolverMemory();
    const bool approximate = method == JointMethod::kConsensus ||
                             method == JointMethod::kFrameTensors;
    const PhaseSummary summary = Solve(method, kAll, approximate ? 50 : 10);
    EXPECT_TRUE(summary.accepted) << JointMethodName(method);
    EXPECT_NEAR(summary.after.Objective(), expected, 1e-3 * expected)
        << JointMethodName(method) << " from " << summary.before.Objective();
  }
}

// The same for other parameters, losses and channels. Breaks if a joint method
// leaves out an axis, or the plain problem does.
TEST_F(JointMethods, ReachTheEnergyOfThePlainProblemInEveryFormulation) {
  TextureProblem& p = scene_.problem;
  const ReconState start = state_;
  const auto images = p.images;
  const auto check = [&](const std::string& what) {
    FinishTextureProblem(&p);
    state_ = start;
    state_.colors.resize(p.NumChannels() * p.texels.size());
    weights_ = StartFrom(&state_, &p);
    const ReconState from = state_;
    memory_ = SolverMemory();
    const PhaseSummary plain = Solve(JointMethod::kSchur, kAll, 12);
    const double expected = plain.after.Objective();
    EXPECT_NEAR(plain.cost_before, plain.before.Objective(), 1e-5 * expected);
    EXPECT_NEAR(plain.cost_after, expected, 1e-5 * expected);
    for (const JointMethod method :
         {JointMethod::kConsensus, JointMethod::kExact}) {
      state_ = from;
      const PhaseSummary summary =
          Solve(method, kAll, method == JointMethod::kExact ? 15 : 50);
      EXPECT_TRUE(summary.accepted) << what;
      EXPECT_NEAR(summary.after.Objective(), expected, 2e-3 * expected)
          << what << " " << JointMethodName(method);
    }
  };
  for (const PlaneKind kind :
       {PlaneKind::kNormalised4, PlaneKind::kOrigin, PlaneKind::kUnit4}) {
    p.formulation = {};
    p.formulation.plane = kind;
    check("plane " + std::to_string(static_cast<int>(kind)));
  }
  for (const PoseKind kind : {PoseKind::kRight, PoseKind::kQuaternion}) {
    p.formulation = {};
    p.formulation.manifold = kind;
    check("manifold " + std::to_string(static_cast<int>(kind)));
  }
  p.formulation = {};
  p.formulation.loss = LossKind::kHuber;
  p.formulation.loss_scale = 0.02;
  check("huber");
  p.formulation = {};
  p.formulation.channels = Channels::kRgb;
  p.more_images = {images, images};
  check("rgb");
}

// What holds the model in place does so in every method: the first pose stays
// where it is, or the cameras' mean motion is none.
TEST_F(JointMethods, KeepTheGauge) {
  const ReconState start = state_;
  for (const JointMethod method : AllJointMethods()) {
    for (const unsigned blocks : {kColors | kPoses, kAll}) {
      const std::string what =
          BlockSetName(blocks) + " " + JointMethodName(method);
      state_ = start;
      memory_ = SolverMemory();
      config_.fix_first_pose = true;
      weights_.pose_prior = false;
      PhaseSummary summary = Solve(method, blocks, 3);
      EXPECT_TRUE(summary.accepted) << what;
      EXPECT_LT(summary.after.e_c, 0.9 * summary.before.e_c) << what;
      EXPECT_TRUE(std::equal(start.poses.begin(),
                             start.poses.begin() + kPoseSize,
                             state_.poses.begin()))
          << what;
      EXPECT_NE(start.poses.back(), state_.poses.back()) << what;

      state_ = start;
      memory_ = SolverMemory();
      config_.fix_first_pose = false;
      config_.remove_common_motion = true;
      summary = Solve(method, blocks, 3);
      EXPECT_TRUE(summary.accepted) << what;
      EXPECT_LT(summary.after.e_c, 0.9 * summary.before.e_c) << what;
      std::vector<Pose> poses;
      for (int k = 0; k < scene_.problem.NumKeyframes(); ++k) {
        poses.push_back(state_.CamFromWorld(k));
      }
      EXPECT_LT(MeanMotion(scene_.problem.initial_cam_from_world, poses).norm(),
                1e-4)
          << what;
      config_.remove_common_motion = false;
    }
  }
}

// A stiff prior holds the poses, in every method.
TEST_F(JointMethods, KeepThePrior) {
  const ReconState start = state_;
  weights_.prior.scale *= 1e4;
  for (const JointMethod method : AllJointMethods()) {
    state_ = start;
    memory_ = SolverMemory();
    EXPECT_TRUE(Solve(method, kAll, 3).accepted);
    for (size_t i = 0; i < start.poses.size(); ++i) {
      EXPECT_NEAR(state_.poses[i], start.poses[i], 1e-4)
          << JointMethodName(method);
    }
    EXPECT_NE(state_.planes, start.planes);
  }
}

// Twice the cost that Ceres minimises is the objective less the terms that the
// phase cannot change. Breaks when a mode forgets a term or a weight, or its
// cost is not that of the state it leaves behind.
TEST_F(JointMethods, TwiceTheCostIsTheEnergy) {
  weights_.texel_weight = 4;
  for (const JointMethod method : AllJointMethods()) {
    for (const unsigned blocks : {kColors | kPoses,
                                  kAll,
                                  unsigned{kPlanes},
                                  unsigned{kPoses},
                                  kPoses | kWarps,
                                  kAll | kWarps}) {
      if (!CanSolve(blocks, method)) continue;
      if (!(blocks & kColors) && method != JointMethod::kConsensus) continue;
      const ReconState start = state_;
      memory_ = SolverMemory();
      // Alternating steps take the colours as they are.
      const PhaseSummary s = Solve(method, blocks, 2);
      EXPECT_TRUE(s.accepted);
      const bool joint = (blocks & kColors) != 0;
      const bool plain = joint && (method == JointMethod::kSchur ||
                                   method == JointMethod::kInner);
      const auto of = [&](const EnergyTerms& e) {
        double sum = e.e_c;
        if (plain || (blocks & kPlanes)) sum += weights_.lambda1 * e.e_p;
        if (plain || (blocks & kWarps)) sum += weights_.lambda2 * e.e_s;
        if (plain || (blocks & kPoses)) sum += e.e_prior;
        return sum;
      };
      const std::string what = s.blocks + " " + JointMethodName(method);
      EXPECT_NEAR(s.cost_before, of(s.before), 1e-5 * of(s.before)) << what;
      EXPECT_NEAR(s.cost_after, of(s.after), 1e-5 * of(s.before)) << what;
      EXPECT_LT(s.after.Objective(), s.before.Objective()) << what;
      state_ = start;
    }
  }
}

// Breaks when a joint mode keeps a worse state, or leaves it unmarked.
TEST_F(JointMethods, WorseResultsAreRolledBackAndMarked) {
  EnergyTerms before = EvaluateEnergy(scene_.problem, weights_, state_);
  before.e_tex *= 1e-3;
  for (const JointMethod method : AllJointMethods()) {
    SolverConfig config = config_;
    config.joint_method = method;
    config.max_joint_iterations = 2;
    ReconState state = state_;
    const PhaseSummary summary = SolveBlocks(
        scene_.problem, weights_, kAll, config, before, &memory_, &state);
    EXPECT_FALSE(summary.accepted);
    EXPECT_EQ(summary.after.e_tex, before.e_tex);
    EXPECT_EQ(state.planes, state_.planes);
    EXPECT_EQ(state.poses, state_.poses);
    EXPECT_EQ(state.colors, state_.colors);
  }
}

// Breaks when a mode starts every phase from the same radius.
TEST_F(JointMethods, CarryTheTrustRegion) {
  for (const JointMethod method : AllJointMethods()) {
    memory_ = SolverMemory();
    memory_.joint_radius = memory_.explicit_radius = 7;
    const ReconState start = state_;
    Solve(method, kAll, 2);
    const bool plain =
        method == JointMethod::kSchur || method == JointMethod::kInner;
    EXPECT_NE(plain ? memory_.explicit_radius : memory_.joint_radius, 7);
    EXPECT_EQ(plain ? memory_.joint_radius : memory_.explicit_radius, 7);
    state_ = start;
  }
}

// CGNR and Cholesky differ in how, not in what they solve.
TEST_F(JointMethods, LinearSolversReachTheSameEnergy) {
  const ReconState start = state_;
  config_.joint_linear_solver = JointLinearSolver::kCholesky;
  const double direct =
      Solve(JointMethod::kConsensus, kAll, 30).after.Objective();
  state_ = start;
  memory_ = SolverMemory();
  config_.joint_linear_solver = JointLinearSolver::kCgnr;
  const double iterative =
      Solve(JointMethod::kConsensus, kAll, 30).after.Objective();
  EXPECT_NEAR(iterative, direct, 1e-3 * direct);
}

}  // namespace
}  // namespace facet
