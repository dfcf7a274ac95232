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

// The paper's alternation. Breaks if "T" is not told from "T+F" or counts get
// lost.
TEST(Schedule, ReadsThePaper) {
  const Schedule schedule = ParseSchedule("10x[C; Phi; T+F]");
  ASSERT_EQ(schedule.size(), 1u);
  EXPECT_EQ(schedule[0].rounds, 10);
  EXPECT_EQ(schedule[0].phases,
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
  EXPECT_EQ(schedule[3].phases, std::vector<unsigned>{kPlanes});
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
                           "100000x[Phi]"}) {
    const Schedule schedule = ParseSchedule(text);
    const std::string printed = ToString(schedule);
    const Schedule again = ParseSchedule(printed);
    ASSERT_EQ(again.size(), schedule.size()) << printed;
    for (size_t g = 0; g < schedule.size(); ++g) {
      EXPECT_EQ(again[g].rounds, schedule[g].rounds) << printed;
      EXPECT_EQ(again[g].phases, schedule[g].phases) << printed;
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

// Breaks if a long count overflows.
TEST(Schedule, HugeCountsAreRefused) {
  EXPECT_NE(ErrorOf("100001x[C]"), "");
  EXPECT_NE(ErrorOf("99999999999999999999x[C]"), "");
}

}  // namespace
}  // namespace facet
