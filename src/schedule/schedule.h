// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Schedules as text: in which order, how often and with which free blocks the
// energy is minimised.
//
//   schedule = group { ";" group }
//   group    = [count "x"] "[" phase { ";" phase } "]"  |  phase
//   phase    = block { "+" block },  block = C | Phi | T | F
//
// "10x[C; Phi; T+F]" is the paper's alternation. White space is free.
#pragma once

#include <string>
#include <vector>

namespace facet {

struct ScheduleGroup {
  int rounds = 1;
  std::vector<unsigned> phases;  // BlockSet bits
};

using Schedule = std::vector<ScheduleGroup>;

// Throws OptionsError that points at the character and lists what is possible.
Schedule ParseSchedule(const std::string& text);

// Throws OptionsError if a phase frees blocks that SolveBlocks cannot solve
// together (problems/solve_blocks.h), so that a run fails at its start.
void CheckSchedule(const Schedule& schedule);

// The sets of blocks that its phases free, in order.
std::vector<unsigned> PhasesOf(const Schedule& schedule);

// Canonical text; ParseSchedule(ToString(s)) gives s back.
std::string ToString(const Schedule& schedule);

}  // namespace facet
