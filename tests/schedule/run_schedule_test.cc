// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "schedule/run_schedule.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "tests/support/tiny_scene.h"

namespace facet {
namespace {

class RunScheduleTest : public testing::Test {
 protected:
  RunScheduleTest() {
    TinySceneOptions options;
    options.texel_spacing_m = 0.06;
    scene_ = MakeTinyScene(options);
    state_ = scene_.truth;
    PerturbPoses(0.0035, 0.005, 1, &state_);
    weights_ = StartFrom(&state_, &scene_.problem);
  }

  Trace Run(const std::string& schedule, const StopRule& stop) {
    return RunSchedule(
        scene_.problem,
        weights_,
        {},
        ParseSchedule(schedule),
        stop,
        [this](const TraceRow&) { ++calls_; },
        &state_);
  }

  TinyScene scene_;
  ReconState state_;
  EnergyWeights weights_;
  size_t calls_ = 0;
};

// One row a phase, in order, each starting where the last one ended. Breaks if
// a phase is skipped or its energy belongs to another state.
TEST_F(RunScheduleTest, TraceHasOneRowAPhaseInOrder) {
  const EnergyTerms start = EvaluateEnergy(scene_.problem, weights_, state_);
  const Trace trace = Run("2x[C; Phi; T]; F", {0});
  EXPECT_EQ(trace.initial.Objective(), start.Objective());
  ASSERT_EQ(trace.rows.size(), 7u);
  EXPECT_EQ(calls_, 7u);
  const char* names[] = {"C", "Phi", "T", "C", "Phi", "T", "F"};
  double before = start.Objective(), wall = 0;
  for (size_t i = 0; i < 7; ++i) {
    const TraceRow& row = trace.rows[i];
    EXPECT_EQ(row.phase.blocks, names[i]);
    EXPECT_EQ(row.group, i < 6 ? 0 : 1);
    EXPECT_EQ(row.round, static_cast<int>(i / 3) + 1);
    EXPECT_EQ(row.phase.before.Objective(), before);
    EXPECT_LE(row.phase.after.Objective(), before * (1 + 1e-6));
    EXPECT_GE(row.wall_s, wall);
    before = row.phase.after.Objective();
    wall = row.wall_s;
  }
  EXPECT_EQ(EvaluateEnergy(scene_.problem, weights_, state_).Objective(),
            before);
}

// A group ends after the first two rounds that gain too little, and the next
// group still runs.
TEST_F(RunScheduleTest, StopRuleEndsTheGroupOnly) {
  StopRule everything_is_too_little;
  everything_is_too_little.relative_decrease = 1;
  const Trace trace = Run("50x[C; T]; 3x[Phi]", everything_is_too_little);
  EXPECT_EQ(trace.rows.size(), 2u * 2u + 2u);
  EXPECT_EQ(trace.rows.back().group, 1);
}

// Breaks if a group's own rule does not win, or reaches its neighbours.
TEST_F(RunScheduleTest, GroupHasItsOwnStopRule) {
  EXPECT_EQ(Run("9x[C]{stop=1}; 5x[C]", {0}).rows.size(), 2u + 5u);
  EXPECT_EQ(Run("9x[C]{stop=0}; 5x[C]", {1}).rows.size(), 9u + 2u);
}

// Breaks if options of a phase do not reach its solver.
TEST_F(RunScheduleTest, PhaseHasItsOwnIterations) {
  const Trace trace = Run("C; T{iterations=1}", {0});
  const PhaseSummary& phase = trace.rows[1].phase;
  EXPECT_GT(phase.problems, 0);
  // Ceres counts the start.
  EXPECT_LE(phase.iterations, 2 * phase.problems);
}

// 0 = never, even when nothing is gained any more.
TEST_F(RunScheduleTest, StopRuleZeroRunsAllRounds) {
  EXPECT_EQ(Run("9x[C]", {0}).rows.size(), 9u);
}

// The rule looks at the decrease over two rounds, relative to the objective
// before them.
TEST_F(RunScheduleTest, StopRuleIsTheDecreaseOverTwoRounds) {
  StopRule stop;
  stop.relative_decrease = 2e-2;
  const Trace trace = Run("200x[C; Phi; T]", stop);
  std::vector<double> objective = {trace.initial.Objective()};
  for (size_t i = 2; i < trace.rows.size(); i += 3) {
    objective.push_back(trace.rows[i].phase.after.Objective());
  }
  ASSERT_LT(objective.size(), 201u);
  ASSERT_GE(objective.size(), 3u);
  for (size_t n = 3; n <= objective.size(); ++n) {
    const double decrease = objective[n - 3] - objective[n - 1];
    EXPECT_EQ(decrease <= 2e-2 * objective[n - 3], n == objective.size()) << n;
  }
}

// Grey walls and a flat mesh: the objective is 0 from the start.
TEST(RunSchedule, StopsWhenThereIsNothingToGain) {
  TinySceneOptions options;
  options.contrast = 0;
  options.relief_m = 0;
  options.texel_spacing_m = 0.1;
  TinyScene scene = MakeTinyScene(options);
  ReconState state = scene.truth;
  const EnergyWeights weights = StartFrom(&state, &scene.problem);
  const Trace trace = RunSchedule(scene.problem,
                                  weights,
                                  {},
                                  ParseSchedule("50x[C; T]"),
                                  {},
                                  nullptr,
                                  &state);
  EXPECT_EQ(trace.rows.size(), 4u);
}

// Breaks if a column is added to the lines but not to the header, or if a
// rolled-back phase or resting problems do not show.
TEST(TraceCsv, EveryLineHasTheColumnsOfTheHeader) {
  Trace trace;
  trace.rows.resize(2);
  trace.rows[0].phase.blocks = "T+F";
  trace.rows[1].phase.blocks = "Phi";
  trace.rows[1].phase.accepted = false;
  trace.rows[1].phase.resting = 17;
  std::istringstream csv(TraceCsv(trace));
  std::vector<std::vector<std::string>> cells;
  for (std::string line; std::getline(csv, line);) {
    cells.emplace_back();
    std::istringstream parts(line);
    for (std::string cell; std::getline(parts, cell, ',');) {
      cells.back().push_back(cell);
    }
  }
  ASSERT_EQ(cells.size(), 4u);
  for (const auto& line : cells) EXPECT_EQ(line.size(), cells[0].size());
  const auto column = [&](const std::string& name) {
    return static_cast<size_t>(
        std::find(cells[0].begin(), cells[0].end(), name) - cells[0].begin());
  };
  const size_t accepted = column("accepted"), phase = column("phase");
  ASSERT_LT(accepted, cells[0].size());
  ASSERT_LT(phase, cells[0].size());
  EXPECT_EQ(cells[1][phase], "initial");
  EXPECT_EQ(cells[2][phase], "T+F");
  EXPECT_EQ(cells[1][accepted], "1");
  EXPECT_EQ(cells[2][accepted], "1");
  EXPECT_EQ(cells[3][accepted], "0");
  const size_t resting = column("resting");
  ASSERT_LT(resting, cells[0].size());
  EXPECT_EQ(cells[1][resting], "0");
  EXPECT_EQ(cells[2][resting], "0");
  EXPECT_EQ(cells[3][resting], "17");
}

}  // namespace
}  // namespace facet
