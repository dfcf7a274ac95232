// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The results of an ablation as text: results.csv, trace.csv, table.md
// (docs/formats.md).
#pragma once

#include <string>
#include <vector>

#include "ablate/plan.h"
#include "ablate/run_result.h"
#include "ablate/statistics.h"

namespace facet {

// One row a run.
std::string ResultsCsv(const AblationPlan& plan,
                       const std::vector<RunResult>& runs);

// One row a run and phase.
std::string TracesCsv(const AblationPlan& plan,
                      const std::vector<RunResult>& runs);

// The runs of one variant in one group of scans.
struct TableCell {
  SampleStatistics sample;      // all finished runs
  SampleStatistics difference;  // paired by scan, against the first variant
  bool kept_apart = false;      // some runs must not be compared in this figure
};

// A group of scans: rows are variants, columns those figures that have a title
// and exist in the group.
struct GroupTable {
  std::string group;
  int scans = 0;
  std::vector<size_t> figures;                // columns, into Figures()
  std::vector<std::vector<TableCell>> cells;  // [variant][column]
  std::vector<int> finished;                  // runs, by variant
};

std::vector<GroupTable> MakeTables(const AblationPlan& plan,
                                   const std::vector<RunResult>& runs);

// Groups in the order of their first scan.
std::vector<std::string> GroupsOf(const AblationPlan& plan);

// "12.3 ± 0.4"; "-" where nothing exists; with "(3 of 5)" where the figure does
// not exist for all `finished` runs, e.g. because some never got to 99 %, and
// "(apart)" as in TableCell.
std::string CellText(const TableCell& cell, int finished);
// Differences carry their sign and the number of pairs.
std::string DifferenceText(const SampleStatistics& difference);

std::string TableMarkdown(const AblationPlan& plan,
                          const std::vector<RunResult>& runs);

// One line on what the marks and columns of the tables mean.
std::string TableLegend();

}  // namespace facet
