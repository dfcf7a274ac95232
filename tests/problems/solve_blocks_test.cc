// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "problems/solve_blocks.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "problems/color_step.h"
#include "problems/explicit_problem.h"
#include "tests/support/tiny_scene.h"
#include "util/errors.h"
#include "util/random.h"

namespace facet {
namespace {

struct Start {
  TinyScene scene;
  ReconState state;
  EnergyWeights weights;
};

// Poses off by 0.2 degrees and 5 mm, planes by 0.2 degrees and 3 mm.
Start MakeStart(double texel_spacing_m = 0.04) {
  TinySceneOptions options;
  options.texel_spacing_m = texel_spacing_m;
  Start start;
  start.scene = MakeTinyScene(options);
  start.state = start.scene.truth;
  PerturbPoses(0.0035, 0.005, 1, &start.state);
  PerturbPlanes(0.0035, 0.003, 2, &start.state);
  start.weights = StartFrom(&start.state, &start.scene.problem);
  return start;
}

PhaseSummary Solve(const Start& start,
                   unsigned blocks,
                   const SolverConfig& config,
                   ReconState* state) {
  SolverMemory memory;
  return SolveBlocks(start.scene.problem,
                     start.weights,
                     blocks,
                     config,
                     EvaluateEnergy(start.scene.problem, start.weights, *state),
                     &memory,
                     state);
}

double Distance(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum);
}

// The closed form against Ceres on the colours alone. Breaks if the mean is
// divided by something else than the number of views.
TEST(SolveColors, IsTheMinimumOverTheColours) {
  Start start = MakeStart(0.1);
  std::fill(start.state.colors.begin(), start.state.colors.end(), 0.2f);
  ReconState by_ceres = start.state;
  ExplicitProblem reference(start.scene.problem, start.weights, &by_ceres);
  reference.Step(kColors, ceres::SPARSE_NORMAL_CHOLESKY, 10);
  SolveColors(start.scene.problem, &start.state);
  for (size_t i = 0; i < start.state.colors.size(); ++i) {
    EXPECT_NEAR(start.state.colors[i], reference.colors()[i], 2e-5) << i;
  }
}

// Colours nobody sees are not invented.
TEST(SolveColors, LeavesUnseenTexelsAlone) {
  Start start = MakeStart(0.1);
  std::fill(start.state.colors.begin(), start.state.colors.end(), 0.123f);
  SolveColors(start.scene.problem, &start.state);
  int unseen = 0;
  for (size_t i = 0; i < start.state.colors.size(); ++i) {
    if (start.scene.problem.views[i] > 0) continue;
    ++unseen;
    EXPECT_EQ(start.state.colors[i], 0.123f);
  }
  EXPECT_GT(unseen, 0);
}

// The first iteration of the compressed production solve is the first iteration
// of the plain problem. Breaks if compression, binning by cell, weights or the
// radius differ; 1e-3 covers float Jacobians (1e-4) and the diagonal shift.
TEST(SolveBlocks, FirstStepIsThatOfTheReference) {
  Start start = MakeStart(0.06);
  AddDepthMoments(&start.scene);
  start.weights.depth_weight = 0.03;
  SolverConfig config;
  config.remove_common_motion = false;
  config.max_plane_iterations = config.max_pose_iterations = 1;
  const struct {
    unsigned blocks;
    ceres::LinearSolverType solver;
  } cases[] = {{kPlanes, ceres::DENSE_QR},
               {kPoses, ceres::SPARSE_NORMAL_CHOLESKY},
               {kWarps, ceres::SPARSE_NORMAL_CHOLESKY},
               {kPoses | kWarps, ceres::SPARSE_NORMAL_CHOLESKY}};
  for (const auto& c : cases) {
    ReconState found = start.state, expected = start.state;
    const PhaseSummary summary = Solve(start, c.blocks, config, &found);
    EXPECT_TRUE(summary.accepted);
    EXPECT_EQ(summary.reverted, 0);
    ExplicitProblem(start.scene.problem, start.weights, &expected)
        .Step(c.blocks, c.solver);
    for (const auto member :
         {&ReconState::planes, &ReconState::poses, &ReconState::warps}) {
      const double step = Distance(start.state.*member, expected.*member);
      EXPECT_LE(Distance(found.*member, expected.*member), 1e-3 * step)
          << BlockSetName(c.blocks);
    }
  }
}

// Only the free blocks may move.
TEST(SolveBlocks, LeavesTheOtherBlocksAlone) {
  const Start start = MakeStart();
  for (const unsigned blocks : {unsigned{kColors},
                                unsigned{kPlanes},
                                unsigned{kPoses},
                                unsigned{kWarps},
                                kPoses | kWarps}) {
    ReconState state = start.state;
    std::fill(state.colors.begin(), state.colors.end(), 0.45f);
    const ReconState before = state;
    SolverConfig config;
    config.remove_common_motion = false;  // would average the colours again
    const PhaseSummary summary = Solve(start, blocks, config, &state);
    EXPECT_TRUE(summary.accepted) << summary.blocks;
    EXPECT_EQ(state.colors != before.colors, (blocks & kColors) != 0);
    EXPECT_EQ(state.planes != before.planes, (blocks & kPlanes) != 0);
    EXPECT_EQ(state.poses != before.poses, (blocks & kPoses) != 0);
    EXPECT_EQ(state.warps != before.warps, (blocks & kWarps) != 0);
  }
}

// A pose step after a warp step sees the warp, and keeps it.
TEST(SolveBlocks, PosesAreSolvedUnderTheWarpThatIsThere) {
  const Start start = MakeStart(0.06);
  ReconState state = start.state;
  Random random(5);
  for (double& f : state.warps) f = 0.3 * random.Normal();
  const ReconState before = state;
  ReconState expected = state;
  SolverConfig config;
  config.remove_common_motion = false;
  config.max_pose_iterations = 1;
  EXPECT_TRUE(Solve(start, kPoses, config, &state).accepted);
  EXPECT_EQ(state.warps, before.warps);
  ExplicitProblem(start.scene.problem, start.weights, &expected)
      .Step(kPoses, ceres::SPARSE_NORMAL_CHOLESKY);
  EXPECT_LE(Distance(state.poses, expected.poses),
            1e-3 * Distance(before.poses, expected.poses));
}

// A caller who claims a lower energy than the state's own makes every result
// look worse: the state must come back bit for bit, marked.
TEST(SolveBlocks, WorseResultIsRolledBackAndMarked) {
  const Start start = MakeStart();
  for (const unsigned blocks :
       {unsigned{kColors}, unsigned{kPlanes}, unsigned{kPoses}}) {
    ReconState state = start.state;
    EnergyTerms before =
        EvaluateEnergy(start.scene.problem, start.weights, state);
    before.e_tex *= 1e-3;
    SolverMemory memory;
    const PhaseSummary summary = SolveBlocks(start.scene.problem,
                                             start.weights,
                                             blocks,
                                             {},
                                             before,
                                             &memory,
                                             &state);
    EXPECT_FALSE(summary.accepted);
    EXPECT_EQ(summary.after.e_tex, before.e_tex);
    EXPECT_EQ(state.planes, start.state.planes);
    EXPECT_EQ(state.poses, start.state.poses);
    EXPECT_EQ(state.colors, start.state.colors);
  }
}

// Steps longer than the limits are scaled back to them (method, Sec. 7.5).
TEST(SolveBlocks, StepsKeepTheLimits) {
  const Start start = MakeStart();
  SolverConfig config;
  config.remove_common_motion = false;
  config.max_rotation_rad = 2e-4;
  config.max_translation_m = 3e-4;
  config.max_plane_offset_m = 2e-4;
  config.max_plane_tilt_rad = 1e-4;
  config.max_warp_px = 0.02;
  ReconState state = start.state;
  ASSERT_TRUE(Solve(start, kPlanes, config, &state).accepted);
  double largest = 0;
  for (int j = 0; j < 3; ++j) {
    const Eigen::Map<const Eigen::Vector4d> a(start.state.planes.data() +
                                              4 * j);
    const Eigen::Map<const Eigen::Vector4d> b(state.planes.data() + 4 * j);
    const double tilt = a.head<3>().cross(b.head<3>()).norm() / 1e-4;
    const double shift = std::abs(a[3] - b[3]) / 2e-4;
    EXPECT_LE(std::max(tilt, shift), 1 + 1e-6);
    EXPECT_NEAR(b.head<3>().norm(), 1, 1e-12);
    largest = std::max({largest, tilt, shift});
  }
  EXPECT_GT(largest, 0.99);

  state = start.state;
  ASSERT_TRUE(Solve(start, kPoses | kWarps, config, &state).accepted);
  largest = 0;
  for (int k = 0; k < start.scene.problem.NumKeyframes(); ++k) {
    const Pose a = start.state.CamFromWorld(k), b = state.CamFromWorld(k);
    const double turn = RotationAngle(b * a.Inverse()) / 2e-4;
    const double shift =
        (b.CenterInSource() - a.CenterInSource()).norm() / 3e-4;
    EXPECT_LE(turn, 1 + 1e-6);
    EXPECT_LE(shift, 1.02);  // scaled along the screw, not the chord
    largest = std::max({largest, turn, shift});
  }
  for (const double f : state.warps) EXPECT_LE(std::abs(f), 0.02 * (1 + 1e-9));
  EXPECT_GT(largest, 0.5);
}

// Keyframes with hardly any texel say too little about their pose.
TEST(SolveBlocks, PoorKeyframesKeepTheirPose) {
  const Start start = MakeStart();
  SolverConfig config;
  config.remove_common_motion = false;
  config.min_frame_observations = start.scene.problem.observations.size();
  ReconState state = start.state;
  const PhaseSummary summary = Solve(start, kPoses, config, &state);
  EXPECT_EQ(summary.problems, 0);
  EXPECT_EQ(state.poses, start.state.poses);
}

// A keyframe that sees nothing, without any prior, must not end the process.
TEST(SolveBlocks, SurvivesAKeyframeWithoutObservations) {
  Start start = MakeStart();
  TextureProblem& p = start.scene.problem;
  const size_t last = p.observations.begin[p.NumKeyframes() - 1];
  p.observations.texel.resize(last);
  p.observations.begin.back() = last;
  FinishTextureProblem(&p);
  start.weights.pose_prior = false;
  SolverConfig config;
  config.remove_common_motion = false;
  config.min_frame_observations = 0;
  for (const unsigned blocks : {unsigned{kPoses}, kPoses | kWarps}) {
    ReconState state = start.state;
    EXPECT_TRUE(Solve(start, blocks, config, &state).accepted);
    const size_t k = 7 * (p.NumKeyframes() - 1);
    EXPECT_TRUE(std::equal(state.poses.begin() + k,
                           state.poses.end(),
                           start.state.poses.begin() + k));
  }
}

// Grey walls say nothing: breaks if noise, a prior or a singular system moves a
// camera. Planes follow the mesh alone.
TEST(SolveBlocks, WithoutTexturePosesStay) {
  TinySceneOptions options;
  options.contrast = 0;
  Start start;
  start.scene = MakeTinyScene(options);
  start.state = start.scene.truth;
  start.weights = StartFrom(&start.state, &start.scene.problem);
  for (const unsigned blocks : {unsigned{kPoses}, kPoses | kWarps}) {
    ReconState state = start.state;
    Solve(start, blocks, {}, &state);
    EXPECT_LT(Distance(state.poses, start.state.poses), 1e-12);
    EXPECT_LT(Distance(state.warps, start.state.warps), 1e-12);
  }
}

TEST(SolveBlocks, ImpossibleSetsAreOptionsErrors) {
  const Start start = MakeStart(0.1);
  ReconState state = start.state;
  EXPECT_THROW(Solve(start, kColors | kWarps, {}, &state), OptionsError);
  EXPECT_THROW(Solve(start, 0, {}, &state), OptionsError);
}

}  // namespace
}  // namespace facet
