// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "ablate/tables.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace facet {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

std::string Number(double value, const char* format = "%.9g") {
  if (!std::isfinite(value)) return "";
  char text[40];
  std::snprintf(text, sizeof(text), format, value);
  return text;
}

// Quoted if it has to be.
std::string Quoted(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + "\"";
}

std::string ComparableText(const RunResult& run) {
  if (run.same_energy) return "yes";
  return run.same_observations ? "other energy" : "other observations";
}

// scan, variant: what the rows of both CSV files begin with.
std::string RunColumns(const AblationPlan& plan, const RunResult& run) {
  return Quoted(plan.scans[run.scan].spec.name) + "," +
         Quoted(plan.variants[run.variant].label);
}

bool Finished(const RunResult& run) { return run.problem.empty(); }

// By scan of the group, the figure of its run of a variant.
std::vector<double> Column(const AblationPlan& plan,
                           const std::vector<RunResult>& runs,
                           const std::string& group,
                           size_t variant,
                           size_t figure,
                           bool compared) {
  std::vector<double> values(plan.scans.size(), kNone);
  for (const RunResult& run : runs) {
    if (!Finished(run) || run.variant != variant ||
        plan.scans[run.scan].spec.group != group) {
      continue;
    }
    values[run.scan] = compared ? run.Compared(figure) : run.figures[figure];
  }
  return values;
}

GroupTable MakeTable(const AblationPlan& plan,
                     const std::vector<RunResult>& runs,
                     const std::string& group) {
  GroupTable table;
  table.group = group;
  for (const ScanPlan& scan : plan.scans) {
    table.scans += scan.spec.group == group ? 1 : 0;
  }
  for (size_t f = 0; f < Figures().size(); ++f) {
    if (Figures()[f].title.empty()) continue;
    const bool exists =
        std::any_of(runs.begin(), runs.end(), [&](const RunResult& run) {
          return Finished(run) && plan.scans[run.scan].spec.group == group &&
                 std::isfinite(run.figures[f]);
        });
    if (exists) table.figures.push_back(f);
  }
  for (size_t v = 0; v < plan.variants.size(); ++v) {
    std::vector<TableCell> cells;
    for (const size_t f : table.figures) {
      const auto values = Column(plan, runs, group, v, f, false);
      const auto compared = Column(plan, runs, group, v, f, true);
      TableCell cell;
      cell.sample = StatisticsOf(values);
      cell.difference =
          PairedDifference(compared, Column(plan, runs, group, 0, f, true));
      cell.kept_apart = StatisticsOf(compared).n < cell.sample.n;
      cells.push_back(cell);
    }
    table.cells.push_back(cells);
    table.finished.push_back(static_cast<int>(
        std::count_if(runs.begin(), runs.end(), [&](const RunResult& run) {
          return Finished(run) && run.variant == v &&
                 plan.scans[run.scan].spec.group == group;
        })));
  }
  return table;
}

std::string EscapeMarkdown(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    if (c == '|') escaped += '\\';
    escaped += c;
  }
  return escaped;
}

void AddRows(const AblationPlan& plan,
             const GroupTable& table,
             bool differences,
             std::string* text) {
  *text += differences ? "\n| difference |" : "\n| variant | runs |";
  std::string rule = differences ? "|---|" : "|---|---|";
  for (const size_t f : table.figures) {
    *text += " " + Figures()[f].title + " |";
    rule += "---|";
  }
  *text += "\n" + rule + "\n";
  for (size_t v = differences ? 1 : 0; v < plan.variants.size(); ++v) {
    *text += "| " + EscapeMarkdown(plan.variants[v].label) + " |";
    if (!differences) {
      *text += " " + std::to_string(table.finished[v]) + " |";
    }
    for (const TableCell& cell : table.cells[v]) {
      *text += " " +
               (differences ? DifferenceText(cell.difference)
                            : CellText(cell, table.finished[v])) +
               " |";
    }
    *text += "\n";
  }
}

}  // namespace

std::string ResultsCsv(const AblationPlan& plan,
                       const std::vector<RunResult>& runs) {
  std::string csv = "scan,variant,group,seed,noise_mm,noise_deg";
  for (const VaryAxis& axis : plan.axes) csv += "," + axis.flag;
  csv += ",status,comparable,observation_fingerprint";
  for (const Figure& figure : Figures()) csv += "," + figure.column;
  csv += ",folder\n";
  for (const RunResult& run : runs) {
    const ScanSpec& scan = plan.scans[run.scan].spec;
    csv += RunColumns(plan, run) + "," + Quoted(scan.group) + "," +
           Number(scan.seed) + "," + Number(scan.noise_mm) + "," +
           Number(scan.noise_deg);
    for (const std::string& value : plan.variants[run.variant].values) {
      csv += "," + Quoted(value);
    }
    csv += "," + Quoted(Finished(run) ? "ok" : run.problem) + "," +
           (Finished(run) ? ComparableText(run) : "") + "," + run.fingerprint;
    for (size_t f = 0; f < Figures().size(); ++f) {
      csv += "," + (run.figures.empty() ? "" : Number(run.figures[f]));
    }
    csv += "," + Quoted(run.folder.substr(plan.folder.size() + 1)) + "\n";
  }
  return csv;
}

std::string TracesCsv(const AblationPlan& plan,
                      const std::vector<RunResult>& runs) {
  std::string csv =
      "scan,variant,level,round,phase,cpu_s,wall_s,iterations,E_tex,E_c,E_p,"
      "E_s,rms_grey,ate_mm,plane_angle_deg,plane_offset_mm\n";
  for (const RunResult& run : runs) {
    for (const TracePoint& p : run.trace) {
      csv += RunColumns(plan, run) + "," + std::to_string(p.level) + "," +
             std::to_string(p.round) + "," + p.phase;
      for (const double value : {p.cpu_s,
                                 p.wall_s,
                                 p.iterations,
                                 p.e_tex,
                                 p.e_c,
                                 p.e_p,
                                 p.e_s,
                                 p.rms_grey,
                                 p.ate_mm,
                                 p.plane_angle_deg,
                                 p.plane_offset_mm}) {
        csv += "," + Number(value);
      }
      csv += "\n";
    }
  }
  return csv;
}

std::vector<std::string> GroupsOf(const AblationPlan& plan) {
  std::vector<std::string> groups;
  for (const ScanPlan& scan : plan.scans) {
    if (std::find(groups.begin(), groups.end(), scan.spec.group) ==
        groups.end()) {
      groups.push_back(scan.spec.group);
    }
  }
  return groups;
}

std::vector<GroupTable> MakeTables(const AblationPlan& plan,
                                   const std::vector<RunResult>& runs) {
  std::vector<GroupTable> tables;
  for (const std::string& group : GroupsOf(plan)) {
    tables.push_back(MakeTable(plan, runs, group));
  }
  return tables;
}

std::string CellText(const TableCell& cell, int finished) {
  const SampleStatistics& sample = cell.sample;
  if (sample.n == 0) return "-";
  std::string text = Number(sample.mean, "%.5g");
  if (sample.n > 1) text += " ± " + Number(sample.spread, "%.2g");
  if (sample.n < finished) {
    text += " (" + std::to_string(sample.n) + " of " +
            std::to_string(finished) + ")";
  }
  return text + (cell.kept_apart ? " (apart)" : "");
}

std::string DifferenceText(const SampleStatistics& difference) {
  if (difference.n == 0) return "-";
  std::string text = Number(difference.mean, "%+.3g");
  if (difference.n > 1) text += " ± " + Number(difference.spread, "%.2g");
  return text + " (" + std::to_string(difference.n) + ")";
}

std::string TableLegend() {
  return "mean ± standard deviation over scans; differences are paired by "
         "scan, "
         "with their standard deviation and the number of pairs. E_tex, E_c: "
         "after the schedule. CPU: of the schedule. CPU to 99 %: until E_tex "
         "is at most E(0) - 0.99 (E(0) - E_best), E_best the lowest of any "
         "variant from the same state. speed-up: the CPU time the first "
         "variant took to the E_tex it ended with, divided by the time to come "
         "as low. -: never, (3 of 5): only in these. ATE, "
         "rotation, RPE, planes: against the truth; PSNR, gradient NCC: "
         "held-out photos after alignment. (apart): "
         "other observations or another energy function, not compared.";
}

std::string TableMarkdown(const AblationPlan& plan,
                          const std::vector<RunResult>& runs) {
  std::string text = "# Ablation\n\n`--vary=" + ToString(plan.axes) + "`\n\n" +
                     TableLegend() + "\n";
  for (const GroupTable& table : MakeTables(plan, runs)) {
    text += "\n## " + table.group + "\n\n" + std::to_string(table.scans) +
            (table.scans == 1 ? " scan\n" : " scans\n");
    AddRows(plan, table, false, &text);
    if (plan.variants.size() > 1) {
      text += "\nDifferences against '" +
              EscapeMarkdown(plan.variants[0].label) + "':\n";
      AddRows(plan, table, true, &text);
    }
  }
  for (const RunResult& run : runs) {
    if (Finished(run)) continue;
    text += "\nFailed: " + plan.scans[run.scan].spec.name + ", " +
            plan.variants[run.variant].label + ": " + run.problem + "\n";
  }
  return text;
}

}  // namespace facet
