// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "ablate/comparison.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "ablate/tables.h"
#include "util/errors.h"

namespace facet {
namespace {

// Two variants of three scans of one group. Energies fall to `end`, in two
// phases that take a second each.
class Constructed {
 public:
  Constructed() {
    plan.folder = "/abl";
    plan.axes = ParseVary("plane=anchored,raw4", {});
    plan.variants = ExpandMatrix(plan.axes, Design::kCross, {""});
    for (int s = 0; s < 3; ++s) {
      ScanPlan scan;
      scan.spec.name = "scan" + std::to_string(s);
      scan.spec.group = "rooms";
      plan.scans.push_back(scan);
      for (size_t v = 0; v < 2; ++v) {
        runs.push_back(Run(static_cast<size_t>(s),
                           v,
                           100.0 * (s + 1),
                           10.0 * (s + 1) - static_cast<double>(v)));
      }
    }
  }

  static RunResult Run(size_t scan, size_t variant, double start, double end) {
    RunResult run;
    run.scan = scan;
    run.variant = variant;
    run.folder = "/abl/runs/x";
    run.problem.clear();
    run.fingerprint = "0123456789abcdef";
    run.figures.assign(Figures().size(),
                       std::numeric_limits<double>::quiet_NaN());
    for (const double e : {start, end + 1, end}) {
      TracePoint point;
      point.e_tex = point.e_c = e;
      point.cpu_s = point.iterations = static_cast<double>(run.trace.size());
      run.trace.push_back(point);
    }
    const auto set = [&](const char* column, double value) {
      run.figures[FigureIndex(column)] = value;
    };
    set("texels", 10);
    set("observations", 50);
    set("lambda1", 2);
    set("lambda2", 0.1);
    set("E_tex", end);
    set("ate_mm", end / 10);
    return run;
  }

  // Of the second variant against the first one.
  TableCell Cell(const std::string& column) const {
    const GroupTable table = MakeTables(plan, runs).at(0);
    for (size_t i = 0; i < table.figures.size(); ++i) {
      if (Figures()[table.figures[i]].column == column) {
        return table.cells[1][i];
      }
    }
    ADD_FAILURE() << "no column " << column;
    return {};
  }

  AblationPlan plan;
  std::vector<RunResult> runs;
};

TEST(Comparison, DifferencesArePairedByScan) {
  Constructed c;
  CompareRuns(&c.runs);
  const TableCell cell = c.Cell("E_tex");
  EXPECT_EQ(cell.sample.n, 3);
  EXPECT_DOUBLE_EQ(cell.sample.mean, 19);
  EXPECT_EQ(cell.difference.n, 3);
  EXPECT_DOUBLE_EQ(cell.difference.mean, -1);
  EXPECT_DOUBLE_EQ(cell.difference.spread, 0);
  EXPECT_FALSE(cell.kept_apart);
}

// E_best is that of the second variant; only it comes within 1 % of the range.
// Breaks if each run is measured by its own best.
TEST(Comparison, TheBestOfAllVariantsIsTheGoal) {
  Constructed c;
  CompareRuns(&c.runs);
  EXPECT_DOUBLE_EQ(BestEnergy(c.runs[0], c.runs), 9);
  EXPECT_TRUE(std::isnan(c.runs[0].Get("cpu_s_to_99")));
  EXPECT_EQ(c.runs[1].Get("cpu_s_to_99"), 2);
}

// The first variant ends at 10 after two seconds; the second is there after
// one. Breaks if the goal is the run's own end or the best of all.
TEST(Comparison, TheSpeedUpIsToTheEndOfTheFirstVariant) {
  Constructed c;
  CompareRuns(&c.runs);
  EXPECT_EQ(c.runs[0].Get("speedup_to_reference"), 1);
  EXPECT_EQ(c.runs[1].Get("cpu_s_to_reference"), 1);
  EXPECT_EQ(c.runs[1].Get("speedup_to_reference"), 2);
  // One that never gets so low has none.
  for (TracePoint& point : c.runs[1].trace) point.e_tex += 5;
  c.runs[1].trace[0].e_tex = 100;
  CompareRuns(&c.runs);
  EXPECT_TRUE(std::isnan(c.runs[1].Get("speedup_to_reference")));
}

TEST(Comparison, OtherObservationsAreRefusedOrKeptApart) {
  Constructed c;
  EXPECT_NO_THROW(CheckSameObservations(c.plan, c.runs[1], c.runs));
  c.runs[1].fingerprint = "fedcba9876543210";
  try {
    CheckSameObservations(c.plan, c.runs[1], c.runs);
    FAIL() << "accepted";
  } catch (const OptionsError& e) {
    for (const char* word : {"scan0",
                             "plane=anchored",
                             "plane=raw4",
                             "--allow_different_observations"}) {
      EXPECT_NE(std::string(e.what()).find(word), std::string::npos)
          << e.what();
    }
  }
  CompareRuns(&c.runs);
  EXPECT_FALSE(c.runs[1].same_observations);
  const TableCell energy = c.Cell("E_tex");
  EXPECT_TRUE(energy.kept_apart);
  EXPECT_EQ(energy.difference.n, 2) << "the other scans still count";
  // The truth does not depend on what was observed.
  EXPECT_EQ(c.Cell("ate_mm").difference.n, 3);
  // The run does not set the goal of the first variant any more.
  EXPECT_DOUBLE_EQ(BestEnergy(c.runs[0], c.runs), 10);
  EXPECT_NE(ResultsCsv(c.plan, c.runs).find("other observations"),
            std::string::npos);
}

// The same observations, but another function of them.
TEST(Comparison, OtherEnergiesAreKeptApart) {
  for (const char* what : {"E(0)", "lambda1", "lambda2"}) {
    Constructed c;
    if (what == std::string("E(0)")) {
      c.runs[1].trace[0].e_tex *= 1.01;
    } else {
      c.runs[1].figures[FigureIndex(what)] *= 2;
    }
    CheckSameObservations(c.plan, c.runs[1], c.runs);
    CompareRuns(&c.runs);
    EXPECT_TRUE(c.runs[1].same_observations) << what;
    EXPECT_FALSE(c.runs[1].same_energy) << what;
    EXPECT_EQ(c.Cell("E_tex").difference.n, 2) << what;
  }
}

TEST(Comparison, AFailedRunLeavesItsPair) {
  Constructed c;
  c.runs[3].problem = "facet-reconstruct ended with code 4, \"no, nothing\"";
  c.runs[3].figures.clear();
  CompareRuns(&c.runs);
  EXPECT_EQ(c.Cell("E_tex").sample.n, 2);
  EXPECT_EQ(c.Cell("E_tex").difference.n, 2);
  EXPECT_NE(TableMarkdown(c.plan, c.runs).find("Failed: scan1, plane=raw4"),
            std::string::npos);
  EXPECT_NE(ResultsCsv(c.plan, c.runs).find("code 4, \"\"no, nothing\"\"\""),
            std::string::npos);
}

// Every row has as many cells as there are columns.
TEST(Comparison, CsvIsRectangular) {
  Constructed c;
  c.runs[2].problem = "failed";
  c.runs[2].figures.clear();
  CompareRuns(&c.runs);
  for (const std::string& csv :
       {ResultsCsv(c.plan, c.runs), TracesCsv(c.plan, c.runs)}) {
    size_t columns = 0, begin = 0;
    while (begin < csv.size()) {
      const size_t end = csv.find('\n', begin);
      const std::string row = csv.substr(begin, end - begin);
      const size_t cells =
          static_cast<size_t>(std::count(row.begin(), row.end(), ','));
      if (columns == 0) columns = cells;
      EXPECT_EQ(cells, columns) << row;
      begin = end + 1;
    }
  }
}

}  // namespace
}  // namespace facet
