// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Planes and keyframes that separate solves leave out
// (SolverConfig::active_tolerance).
#include "problems/rest.h"

#include <gtest/gtest.h>

#include "problems/solve_blocks.h"
#include "tests/support/tiny_scene.h"
#include "util/parallel_for.h"

namespace facet {
namespace {

constexpr unsigned kAlternation[] = {kColors, kPlanes, kPoses | kWarps};

class Rest : public testing::Test {
 protected:
  Rest() {
    TinySceneOptions options;
    options.texel_spacing_m = 0.06;
    scene_ = MakeTinyScene(options);
    state_ = scene_.truth;
    PerturbPoses(0.0035, 0.005, 1, &state_);
    PerturbPlanes(0.0035, 0.003, 2, &state_);
    weights_ = StartFrom(&state_, &scene_.problem);
    config_.remove_common_motion = false;
    config_.trace_rms_grey = false;
    config_.active_tolerance = 1e-3;
  }

  PhaseSummary Solve(unsigned blocks) {
    return SolveBlocks(scene_.problem,
                       weights_,
                       blocks,
                       config_,
                       EvaluateEnergy(scene_.problem, weights_, state_),
                       &memory_,
                       &state_);
  }

  std::vector<PhaseSummary> Alternate(int rounds) {
    std::vector<PhaseSummary> phases;
    for (int round = 0; round < rounds; ++round) {
      for (const unsigned blocks : kAlternation)
        phases.push_back(Solve(blocks));
    }
    return phases;
  }

  double Objective() const {
    return EvaluateEnergy(scene_.problem, weights_, state_).Objective();
  }

  // Solves `blocks` alone until they may all rest.
  void Settle(unsigned blocks) {
    const double tolerance = config_.active_tolerance;
    config_.active_tolerance = 0;
    for (int i = 0; i < 30; ++i) Solve(blocks);
    config_.active_tolerance = tolerance;
    Solve(blocks);
  }

  TinyScene scene_;
  ReconState state_;
  EnergyWeights weights_;
  SolverConfig config_;
  SolverMemory memory_;
};

// Breaks if the tolerance 0 is not an exact off, even at costs of 0.
TEST_F(Rest, NothingRestsWithoutATolerance) {
  RestMemory memory;
  for (memory.cost = 0; memory.cost < 2; ++memory.cost) {
    EXPECT_FALSE(Rests(memory.cost, 0, &memory));
    EXPECT_TRUE(Rests(memory.cost, 1e-9, &memory));
  }
  config_.active_tolerance = 0;
  for (const PhaseSummary& phase : Alternate(12)) {
    EXPECT_EQ(phase.resting, 0) << phase.blocks;
    EXPECT_EQ(phase.problems > 0, phase.blocks != "C") << phase.blocks;
  }
}

// Breaks if a resting problem moves, is counted as solved, or lacks in the
// costs of the phase.
TEST_F(Rest, WhatHasConvergedRestsAndStays) {
  for (const unsigned blocks : {unsigned{kPlanes},
                                unsigned{kPoses},
                                unsigned{kWarps},
                                kPoses | kWarps}) {
    Settle(blocks);
    const ReconState before = state_;
    const PhaseSummary s = Solve(blocks);
    EXPECT_TRUE(s.accepted);
    EXPECT_EQ(s.problems, 0) << s.blocks;
    EXPECT_EQ(s.iterations, 0) << s.blocks;
    EXPECT_EQ(s.resting,
              blocks == kPlanes ? scene_.problem.NumPlanes()
                                : scene_.problem.NumKeyframes());
    EXPECT_EQ(state_.planes, before.planes) << s.blocks;
    EXPECT_EQ(state_.poses, before.poses) << s.blocks;
    EXPECT_EQ(state_.warps, before.warps) << s.blocks;
    EXPECT_EQ(s.after.Objective(), s.before.Objective()) << s.blocks;
    EXPECT_EQ(s.cost_after, s.cost_before) << s.blocks;
  }
}

// The costs of a phase are the terms that it can change, whoever rests.
TEST_F(Rest, CostsOfAPhaseIncludeWhatRests) {
  int mixed = 0;
  for (const PhaseSummary& s : Alternate(25)) {
    if (s.blocks == "C") continue;
    mixed += s.resting > 0 && s.problems > 0 ? 1 : 0;
    const auto of = [&](const EnergyTerms& e) {
      return e.e_c + (s.blocks == "Phi" ? weights_.lambda1 * e.e_p
                                        : e.e_prior + weights_.lambda2 * e.e_s);
    };
    EXPECT_TRUE(s.accepted);
    EXPECT_NEAR(s.cost_before, of(s.before), 1e-5 * of(s.before)) << s.blocks;
    EXPECT_NEAR(s.cost_after, of(s.after), 1e-5 * of(s.before)) << s.blocks;
  }
  EXPECT_GT(mixed, 0);
}

// Breaks if rest is for ever, or one keyframe wakes all.
TEST_F(Rest, AKeyframeThatIsMovedWakesUpAndReturns) {
  Settle(kPoses);
  const ReconState settled = state_;
  const double objective = Objective();
  ReconState moved = state_;
  PerturbPoses(0.002, 0.003, 7, &moved);
  std::copy_n(moved.poses.begin() + 7 * 3, 7, state_.poses.begin() + 7 * 3);
  ASSERT_GT(Objective(), objective * 1.01);
  const PhaseSummary s = Solve(kPoses);
  EXPECT_EQ(s.problems, 1);
  EXPECT_EQ(s.resting, scene_.problem.NumKeyframes() - 1);
  Settle(kPoses);
  EXPECT_LT(Objective(), objective * (1 + config_.active_tolerance));
  for (int k = 0; k < scene_.problem.NumKeyframes(); ++k) {
    const Pose a = settled.CamFromWorld(k), b = state_.CamFromWorld(k);
    EXPECT_LT((a.CenterInSource() - b.CenterInSource()).norm(),
              k == 3 ? 0.001 : 1e-6);
  }
}

// Costs are compared with those after the last solve: breaks if with those of
// the last phase, where steps below the tolerance would never wake anybody.
TEST_F(Rest, SmallChangesAddUp) {
  for (const double sign : {-1.0, 1.0}) {
    RestMemory memory;
    memory.cost = 5;
    const double change = sign * 0.6 * kWakeFactor * 1e-3;
    EXPECT_TRUE(Rests(5 * (1 + change), 1e-3, &memory));
    EXPECT_FALSE(Rests(5 * (1 + 2 * change), 1e-3, &memory));
  }
}

// What all keyframes share is found by many small gains: breaks if what gains
// little is never looked at again.
TEST_F(Rest, NothingRestsForLong) {
  Settle(kPlanes);
  memory_ = SolverMemory();
  for (int round = 0; round < 3; ++round) {
    EXPECT_EQ(Solve(kPlanes).problems, scene_.problem.NumPlanes());
    for (int i = 0; i < kMaxRest; ++i) EXPECT_EQ(Solve(kPlanes).problems, 0);
  }
}

// {T} and {F} of one keyframe have costs of their own: breaks if one's rest is
// taken for the other's, as after a solve of the poses alone warps must move.
TEST_F(Rest, BlockSetsDoNotMix) {
  Settle(kPoses);
  const PhaseSummary s = Solve(kWarps);
  EXPECT_EQ(s.resting, 0);
  EXPECT_GT(s.problems, 0);
  EXPECT_LT(s.after.Objective(), s.before.Objective());
}

// Costs of a state that was taken back must not count.
TEST_F(Rest, ARolledBackPhaseWakesAll) {
  Settle(kPlanes);
  Settle(kPoses);
  EnergyTerms before = EvaluateEnergy(scene_.problem, weights_, state_);
  before.e_tex *= 1e-3;
  EXPECT_FALSE(
      SolveBlocks(
          scene_.problem, weights_, kPoses, config_, before, &memory_, &state_)
          .accepted);
  EXPECT_EQ(Solve(kPoses).resting, 0);
  EXPECT_EQ(Solve(kPlanes).resting, 0);
}

// A solve without a successful step is not at its minimum: the next one starts
// with a smaller trust region.
TEST_F(Rest, FailedSolvesStayAwake) {
  ceres::Solver::Summary solved;
  solved.termination_type = ceres::NO_CONVERGENCE;
  const auto rest = [&](double cost) {
    return RestAfter(solved, 1, cost, 1e-3).cost;
  };
  solved.initial_cost = solved.final_cost = 1;
  EXPECT_LT(rest(1), 0);
  solved.termination_type = ceres::CONVERGENCE;
  EXPECT_EQ(rest(1), 1);
  solved.termination_type = ceres::NO_CONVERGENCE;
  solved.final_cost = 0.5;
  EXPECT_LT(rest(0.5), 0);
  EXPECT_EQ(rest(0.9999), 0.9999);
  EXPECT_EQ(rest(1), 1);  // undone: it cannot follow
}

// What the saving costs: breaks if blocks fall asleep on their way.
TEST_F(Rest, EnergiesAtTheEndAreAboutTheSame) {
  const ReconState start = state_;
  const double first = Objective();
  config_.active_tolerance = 0;
  Alternate(30);
  const double without = Objective();
  state_ = start;
  memory_ = SolverMemory();
  config_.active_tolerance = 1e-3;
  int resting = 0, problems = 0;
  for (const PhaseSummary& s : Alternate(30)) {
    resting += s.resting;
    problems += s.problems;
  }
  EXPECT_GT(resting, problems / 8);
  EXPECT_LT(Objective() - without, 0.02 * (first - without));
}

// Breaks if who rests depends on the order in which problems are solved.
TEST_F(Rest, SameBytesAtAnyNumberOfThreads) {
  const ReconState start = state_;
  std::vector<ReconState> states;
  std::vector<int> resting;
  for (const int threads : {1, 4}) {
    SetNumThreads(threads);
    state_ = start;
    memory_ = SolverMemory();
    int sum = 0;
    for (const PhaseSummary& s : Alternate(20)) sum += s.resting;
    states.push_back(state_);
    resting.push_back(sum);
  }
  SetNumThreads(0);
  EXPECT_GT(resting[0], 0);
  EXPECT_EQ(resting[0], resting[1]);
  EXPECT_EQ(states[0].planes, states[1].planes);
  EXPECT_EQ(states[0].poses, states[1].poses);
  EXPECT_EQ(states[0].warps, states[1].warps);
  EXPECT_EQ(states[0].colors, states[1].colors);
}

}  // namespace
}  // namespace facet
