// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "schedule/schedule.h"

#include <gtest/gtest.h>

#include "problems/solve_blocks.h"
#include "util/errors.h"

namespace facet {
namespace {

std::string ErrorOf(const std::string& text) {
  try {
    ParseSchedule(text);
  } catch (const OptionsError& error) {
    return error.what();
  }
  return "";
}

std::vector<unsigned> BlocksOf(const ScheduleGroup& group) {
  std::vector<unsigned> blocks;
  for (const SchedulePhase& phase : group.phases) {
    blocks.push_back(phase.blocks);
  }
  return blocks;
}

// The paper's alternation. Breaks if "T" is not told from "T+F" or counts get
// lost.
TEST(Schedule, ReadsThePaper) {
  const Schedule schedule = ParseSchedule("10x[C; Phi; T+F]");
  ASSERT_EQ(schedule.size(), 1u);
  EXPECT_EQ(schedule[0].rounds, 10);
  EXPECT_EQ(BlocksOf(schedule[0]),
            (std::vector<unsigned>{kColors, kPlanes, kPoses | kWarps}));
}

// Breaks if a group without count or brackets means something else than one
// round.
TEST(Schedule, CountsAndBracketsAreOptional) {
  const Schedule schedule = ParseSchedule("T;[C;T]; 3x[F] ;Phi");
  ASSERT_EQ(schedule.size(), 4u);
  EXPECT_EQ(schedule[0].rounds, 1);
  EXPECT_EQ(schedule[1].rounds, 1);
  EXPECT_EQ(schedule[1].phases.size(), 2u);
  EXPECT_EQ(schedule[2].rounds, 3);
  EXPECT_EQ(BlocksOf(schedule[3]), std::vector<unsigned>{kPlanes});
}

// White space is free, and the canonical text is a fixed point.
TEST(Schedule, PrintedScheduleReadsBack) {
  for (const char* text : {"C",
                           "10x[C; Phi; T+F]",
                           "5x[C;T];  10 x [ C ; Phi ; T + F ] ;C",
                           "[C;Phi]",
                           "2x[T]",
                           "F+T",
                           " 1x[C] ",
                           "100000x[Phi]",
                           "C+T { iterations = 3 }",
                           "[C+Phi+T{joint=frame_tensors,iterations=12}]",
                           "T+F{decoupled}; Phi{iterations=2}",
                           "6x[C; T]{stop=1e-3}; [C]{stop=0}; [F]{ stop=0.3 }",
                           "C+Phi+T+F{joint=schur}"}) {
    const Schedule schedule = ParseSchedule(text);
    const std::string printed = ToString(schedule);
    const Schedule again = ParseSchedule(printed);
    ASSERT_EQ(again.size(), schedule.size()) << printed;
    for (size_t g = 0; g < schedule.size(); ++g) {
      EXPECT_EQ(again[g].rounds, schedule[g].rounds) << printed;
      EXPECT_EQ(again[g].phases, schedule[g].phases) << printed;
      EXPECT_EQ(again[g].stop, schedule[g].stop) << printed;
    }
    EXPECT_EQ(ToString(again), printed);
  }
}

// The message points at the character (counted from 1, with a caret under it)
// and lists what is possible.
TEST(Schedule, ErrorsPointAtTheCharacter) {
  const struct {
    const char* text;
    int character;
  } cases[] = {
      {"", 1},
      {"C; X", 4},
      {"10x[C; Phj; T]", 8},
      {"10[C]", 3},
      {"10x C", 5},
      {"[C; T", 6},
      {"[C; [Phi]]", 5},
      {"2x[3x[C]]", 4},
      {"C T", 3},
      {"C+", 3},
      {"C]", 2},
      {"0x[C]", 1},
      {"C;", 3},
      {"[]", 2},
      {"-1x[C]", 1},
      {"Phix", 1},
      {"c", 1},
      {"C; Phi+T", 4},
      {"C+T+F", 1},
      {"C+T{iterations=0}", 16},
      {"C+T{iterations=}", 16},
      {"C+T{iterations 3}", 16},
      {"C+T{iteration=3}", 5},
      {"C+T{}", 5},
      {"C+T{iterations=3", 17},
      {"C+T{iterations=3 joint=exact}", 18},
      {"C+T{joint=best}", 11},
      {"T{joint=exact}", 3},
      {"C{iterations=2}", 3},
      {"C+T{decoupled}", 5},
      {"[C]{iterations=2}", 5},
      {"2x[C]{stop=-1}", 12},
      {"2x[C]{stop=2}", 12},
      {"2x[C]{stop=x}", 12},
      {"C{stop=0.1}", 3},
  };
  for (const auto& c : cases) {
    const std::string error = ErrorOf(c.text);
    const std::string where = "at character " + std::to_string(c.character);
    EXPECT_NE(error.find(where + ":"), std::string::npos) << c.text << "\n"
                                                          << error;
    EXPECT_NE(error.find("\n  " + std::string(c.character - 1, ' ') + "^"),
              std::string::npos)
        << error;
    for (const char* block : {"C (", "Phi (", "T (", "F ("}) {
      EXPECT_NE(error.find(block), std::string::npos) << error;
    }
  }
}

// Breaks if an option of a phase reaches another setting than its own, or
// others lose theirs.
TEST(Schedule, OptionsOfAPhaseWinOverThoseOfTheRun) {
  SolverConfig config;
  config.max_pose_iterations = 50;
  config.joint_method = JointMethod::kExact;
  const Schedule schedule = ParseSchedule(
      "2x[C+T{iterations=3, joint=frozen}; T+F{decoupled}; T]{stop=0.01}; C");
  const SolverConfig joint = PhaseConfig(config, schedule[0].phases[0]);
  EXPECT_EQ(joint.max_joint_iterations, 3);
  EXPECT_EQ(joint.max_pose_iterations, 3);
  EXPECT_EQ(joint.joint_method, JointMethod::kFrozen);
  EXPECT_FALSE(joint.decouple_warps);
  EXPECT_TRUE(PhaseConfig(config, schedule[0].phases[1]).decouple_warps);
  const SolverConfig pose = PhaseConfig(config, schedule[0].phases[2]);
  EXPECT_EQ(pose.max_pose_iterations, 50);
  EXPECT_EQ(pose.joint_method, JointMethod::kExact);
  EXPECT_EQ(schedule[0].stop, 0.01);
  EXPECT_FALSE(schedule[1].stop.has_value());
}

// What can be solved together depends on the method, the phase's own or that
// of the run. Breaks if a run with explicit colours is refused a full joint
// phase, or one with eliminated colours gets as far as the phase.
TEST(Schedule, BlocksAreCheckedAgainstTheMethod) {
  EXPECT_NE(ErrorOf("C+Phi+T+F"), "");
  EXPECT_EQ(ErrorOf("C+Phi+T+F{joint=inner}"), "");
  EXPECT_NO_THROW(ParseSchedule("C+Phi+T+F", JointMethod::kSchur));
  EXPECT_THROW(ParseSchedule("C+Phi+T+F{joint=consensus}", JointMethod::kSchur),
               OptionsError);
}

// Breaks if coarse levels free a warp, lose the poses of a phase, or spend time
// on groups that were there for the warps.
TEST(Schedule, CoarseLevelsHaveNoWarps) {
  EXPECT_EQ(ToString(WithoutWarps(
                ParseSchedule("4x[Phi; C+T{iterations=3}]; 5x[C; Phi; F]; "
                              "2x[C; T+F{decoupled}]{stop=0.1}; F"))),
            "4x[Phi; C+T{iterations=3}]; 2x[C; T]{stop=0.1}");
}

// Breaks if a long count overflows.
TEST(Schedule, HugeCountsAreRefused) {
  EXPECT_NE(ErrorOf("100001x[C]"), "");
  EXPECT_NE(ErrorOf("99999999999999999999x[C]"), "");
}

}  // namespace
}  // namespace facet
