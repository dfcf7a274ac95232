// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Schedules as text: in which order, how often and with which free blocks the
// energy is minimised.
//
//   schedule = group { ";" group }
//   group    = [count "x"] "[" phase { ";" phase } "]" [options]  |  phase
//   phase    = block { "+" block } [options],  block = C | Phi | T | F
//   options  = "{" name ["=" value] { "," name ["=" value] } "}"
//
// "10x[C; Phi; T+F]" is the paper's alternation. White space is free. Options
// of a phase say what SolverConfig (problems/solve_blocks.h) says for the whole
// run:
//
//   iterations=N   of each Ceres problem of the phase
//   joint=NAME     method of a joint solve (JointMethod)
//   decoupled      T+F alone: poses first, then warps, colours as they were
//
// and the option of a group
//
//   stop=X         its stop rule (schedule/run_schedule.h); 0 = all rounds
//
// e.g. "4x[C+Phi+T{iterations=3}]{stop=1e-3}; 5x[C; T+F{decoupled}]".
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "problems/solve_blocks.h"

namespace facet {

struct SchedulePhase {
  unsigned blocks = 0;  // BlockSet bits, a set that SolveBlocks can solve
  std::optional<int> iterations;
  std::optional<JointMethod> joint;
  bool decoupled = false;

  bool operator==(const SchedulePhase& other) const {
    return blocks == other.blocks && iterations == other.iterations &&
           joint == other.joint && decoupled == other.decoupled;
  }
};

struct ScheduleGroup {
  int rounds = 1;
  std::vector<SchedulePhase> phases;
  std::optional<double> stop;
};

using Schedule = std::vector<ScheduleGroup>;

// Throws OptionsError that points at the character and lists what is possible.
// `method` is that of joint phases which do not name one: what can be solved
// together depends on it, and a run shall fail at its start.
Schedule ParseSchedule(const std::string& text,
                       JointMethod method = JointMethod::kConsensus);

// What its phases solve, in order; `method` is that of joint phases which do
// not name one.
std::vector<SolvedSet> PhasesOf(const Schedule& schedule, JointMethod method);

// Canonical text; ParseSchedule(ToString(s)) gives s back.
std::string ToString(const Schedule& schedule);
std::string ToString(const SchedulePhase& phase);

// What coarse pyramid levels do: the schedule without warps. A group that moves
// no pose then is left out.
Schedule WithoutWarps(const Schedule& schedule);

// `config` with the options of the phase in it.
SolverConfig PhaseConfig(const SolverConfig& config,
                         const SchedulePhase& phase);

}  // namespace facet
