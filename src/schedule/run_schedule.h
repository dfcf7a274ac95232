// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Runs a schedule and records a trace.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "problems/solve_blocks.h"
#include "schedule/schedule.h"

namespace facet {

struct StopRule {
  // A group ends early when the objective fell by less than this share over two
  // rounds. 0 = never. The group's own option in the schedule wins.
  double relative_decrease = 1e-4;
};

struct TraceRow {
  int level = 0;             // of the image pyramid, 0 = finest
  int group = 0, round = 0;  // round counts through the whole schedule
  PhaseSummary phase;
  double wall_s = 0, cpu_s = 0;  // since the start of the schedule
  // After the phase; only with SolverConfig::trace_states.
  std::vector<Pose> cam_from_world;
  std::vector<Plane> planes;
};

struct Trace {
  EnergyTerms initial;
  std::vector<TraceRow> rows;
};

// Optimises *state in place. `on_row` is called after every phase (for
// progress tables); may be empty.
Trace RunSchedule(const TextureProblem& problem,
                  const EnergyWeights& weights,
                  const SolverConfig& config,
                  const Schedule& schedule,
                  const StopRule& stop,
                  const std::function<void(const TraceRow&)>& on_row,
                  ReconState* state);

// trace.csv: one line a phase, preceded by one for the initial state. Columns
// with units are described in docs/formats.md.
std::string TraceCsv(const Trace& trace);

}  // namespace facet
