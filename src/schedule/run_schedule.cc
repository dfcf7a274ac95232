// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "schedule/run_schedule.h"

#include <cstdio>

#include "util/resources.h"

namespace facet {
namespace {

std::string CsvLine(int level,
                    int round,
                    const std::string& phase,
                    const EnergyTerms& e,
                    const PhaseSummary* summary,
                    double wall_s,
                    double cpu_s) {
  char line[512];
  std::snprintf(
      line,
      sizeof(line),
      "%d,%d,%s,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g,%.6f,%zu,%zu,%zu,%zu,%d,"
      "%d,%d,%d,%.3f,%.3f,%d\n",
      level,
      round,
      phase.c_str(),
      e.e_c,
      e.e_p,
      e.e_s,
      e.e_tex,
      e.e_prior,
      e.e_depth,
      e.SumOfTerms(),
      e.rms_grey,
      e.observations,
      e.clamped,
      e.behind,
      e.lost,
      summary ? summary->accepted : 1,
      summary ? summary->problems : 0,
      summary ? summary->iterations : 0,
      summary ? summary->reverted : 0,
      wall_s,
      cpu_s,
      summary ? summary->resting : 0);
  return line;
}

void KeepState(const TextureProblem& problem,
               const ReconState& state,
               TraceRow* row) {
  for (int k = 0; k < problem.NumKeyframes(); ++k) {
    row->cam_from_world.push_back(state.CamFromWorld(k));
  }
  for (int j = 0; j < problem.NumPlanes(); ++j) {
    row->planes.push_back(state.PlaneAt(j, problem.anchors[j]));
  }
}

}  // namespace

Trace RunSchedule(const TextureProblem& problem,
                  const EnergyWeights& weights,
                  const SolverConfig& config,
                  const Schedule& schedule,
                  const StopRule& stop,
                  const std::function<void(const TraceRow&)>& on_row,
                  ReconState* state) {
  const Stopwatch watch;
  Trace trace;
  trace.initial =
      EvaluateEnergy(problem, weights, *state, config.trace_rms_grey);
  SolverMemory memory;
  EnergyTerms current = trace.initial;
  int round = 0;
  for (size_t g = 0; g < schedule.size(); ++g) {
    const double enough = schedule[g].stop.value_or(stop.relative_decrease);
    std::vector<double> objective = {current.Objective()};
    for (int r = 0; r < schedule[g].rounds; ++r) {
      ++round;
      for (const SchedulePhase& phase : schedule[g].phases) {
        TraceRow row;
        row.group = static_cast<int>(g);
        row.round = round;
        row.phase = SolveBlocks(problem,
                                weights,
                                phase.blocks,
                                PhaseConfig(config, phase),
                                current,
                                &memory,
                                state);
        current = row.phase.after;
        row.wall_s = watch.WallSeconds();
        row.cpu_s = watch.CpuSecondsSince();
        if (config.trace_states) KeepState(problem, *state, &row);
        trace.rows.push_back(row);
        if (on_row) on_row(row);
      }
      objective.push_back(current.Objective());
      const size_t n = objective.size();
      if (enough > 0 && n >= 3 &&
          objective[n - 3] - objective[n - 1] <= enough * objective[n - 3]) {
        break;
      }
    }
  }
  return trace;
}

std::string TraceCsv(const Trace& trace) {
  std::string csv =
      "level,round,phase,E_c,E_p_m2,E_s_px2,E_tex,E_prior,E_depth,E_terms,rms_"
      "grey_255,"
      "observations,clamped,behind,lost,accepted,problems,iterations,reverted,"
      "wall_s,cpu_s,resting\n";
  csv += CsvLine(0, 0, "initial", trace.initial, nullptr, 0, 0);
  for (const TraceRow& row : trace.rows) {
    csv += CsvLine(row.level,
                   row.round,
                   row.phase.blocks,
                   row.phase.after,
                   &row.phase,
                   row.wall_s,
                   row.cpu_s);
  }
  return csv;
}

}  // namespace facet
