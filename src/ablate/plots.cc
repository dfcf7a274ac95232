// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "ablate/plots.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "ablate/comparison.h"
#include "ablate/statistics.h"
#include "ablate/tables.h"

namespace facet {
namespace {

enum class Quantity { kTex, kColor, kGap };

double ValueAt(const Curve& curve, double x) {
  size_t i = 1;
  while (i < curve.x.size() && curve.x[i] < x) ++i;
  if (i >= curve.x.size()) return curve.y.back();
  const double width = curve.x[i] - curve.x[i - 1];
  if (!(width > 0) || x <= curve.x[i - 1]) return curve.y[i - 1];
  const double t = (x - curve.x[i - 1]) / width;
  return (1 - t) * curve.y[i - 1] + t * curve.y[i];
}

// What a run contributes to a line; empty if there is nothing to show.
Curve EnergyCurve(const RunResult& run,
                  const std::vector<RunResult>& runs,
                  Quantity quantity,
                  bool against_time) {
  Curve curve;
  const double start_tex = run.trace[0].e_tex, start_c = run.trace[0].e_c;
  const double best = BestEnergy(run, runs);
  if (!(start_tex > 0) || !(start_c > 0)) return curve;
  if (quantity == Quantity::kGap && !(best < start_tex)) return curve;
  for (const TracePoint& point : run.trace) {
    double y = point.e_tex / start_tex;
    if (quantity == Quantity::kColor) y = point.e_c / start_c;
    if (quantity == Quantity::kGap) {
      y = (point.e_tex - best) / (start_tex - best);
    }
    const double x = against_time ? point.cpu_s : point.iterations;
    // Of phases without iterations the last one counts.
    if (!curve.x.empty() && curve.x.back() >= x && curve.x.size() > 1) {
      curve.y.back() = y;
    } else {
      curve.x.push_back(x);
      curve.y.push_back(y);
    }
  }
  return curve;
}

class GroupPlots {
 public:
  GroupPlots(const AblationPlan& plan,
             const std::vector<RunResult>& runs,
             const std::string& group)
      : plan_(plan), runs_(runs), group_(group) {}

  void AddTo(std::vector<NamedPlot>* plots) const {
    for (const bool against_time : {true, false}) {
      AddEnergy(Quantity::kTex, against_time, plots);
      AddEnergy(Quantity::kColor, against_time, plots);
      AddEnergy(Quantity::kGap, against_time, plots);
    }
    AddErrors("ate_mm", "ate_input_mm", "ATE [mm]", plots);
    AddErrors("plane_angle_deg",
              "plane_angle_input_deg",
              "mean plane angle error [deg]",
              plots);
    AddErrors("plane_offset_mm",
              "plane_offset_input_mm",
              "mean plane offset error [mm]",
              plots);
  }

 private:
  std::vector<const RunResult*> RunsOf(size_t variant) const {
    std::vector<const RunResult*> found;
    for (const RunResult& run : runs_) {
      if (run.problem.empty() && run.variant == variant &&
          plan_.scans[run.scan].spec.group == group_) {
        found.push_back(&run);
      }
    }
    return found;
  }

  void AddEnergy(Quantity quantity,
                 bool against_time,
                 std::vector<NamedPlot>* plots) const {
    Plot plot;
    const char* name = "E_tex";
    plot.y_label = "E_tex / E_tex(0)";
    if (quantity == Quantity::kColor) {
      name = "E_c";
      plot.y_label = "E_c / E_c(0)";
    }
    if (quantity == Quantity::kGap) {
      name = "gap";
      plot.y_label = "(E_tex - E_best) / (E_tex(0) - E_best)";
      plot.log_y = true;
      plot.level = 0.01;
      plot.level_label = "99 % reached";
    }
    plot.x_label = against_time ? "CPU time [s]"
                                : "iterations (mean over a phase's problems)";
    for (size_t v = 0; v < plan_.variants.size(); ++v) {
      std::vector<Curve> curves;
      for (const RunResult* run : RunsOf(v)) {
        if (!run->same_energy) continue;
        Curve curve = EnergyCurve(*run, runs_, quantity, against_time);
        if (!curve.x.empty()) curves.push_back(std::move(curve));
      }
      if (curves.empty()) continue;
      PlotLine line = Line(v);
      line.markers = curves.size() == 1;
      Curve mean = MeanCurve(curves);
      // The best variant ends at a gap of 0, which has no logarithm.
      if (quantity == Quantity::kGap) {
        for (double& y : mean.y) y = std::max(y, 1e-4);
      }
      line.x = std::move(mean.x);
      line.y = std::move(mean.y);
      plot.lines.push_back(std::move(line));
    }
    if (plot.lines.empty()) return;
    plot.title = group_ + ": " +
                 (quantity == Quantity::kGap ? "energy left to gain"
                                             : std::string(name));
    Add(std::string(name) + (against_time ? "_time" : "_iterations"),
        std::move(plot),
        plots);
  }

  // A dot a variant: error at the end against the time it took.
  void AddErrors(const std::string& column,
                 const std::string& input_column,
                 const std::string& label,
                 std::vector<NamedPlot>* plots) const {
    Plot plot;
    plot.title = group_ + ": " + label + " at the end";
    plot.x_label = "CPU time of the schedule [s]";
    plot.y_label = label;
    plot.level_label = "input";
    for (size_t v = 0; v < plan_.variants.size(); ++v) {
      std::vector<double> times, errors, inputs;
      for (const RunResult* run : RunsOf(v)) {
        times.push_back(run->Get("cpu_s"));
        errors.push_back(run->Get(column));
        inputs.push_back(run->Get(input_column));
      }
      const Sample time = Summarize(times), error = Summarize(errors);
      if (error.n == 0) continue;
      plot.level = Summarize(inputs).mean;
      PlotLine line = Line(v);
      line.x = {time.mean};
      line.y = {error.mean};
      line.markers = true;
      line.connected = false;
      plot.lines.push_back(line);
    }
    if (plot.lines.empty()) return;
    Add(column, std::move(plot), plots);
  }

  PlotLine Line(size_t variant) const {
    PlotLine line;
    line.label = plan_.variants[variant].label;
    line.index = variant;
    return line;
  }

  void Add(const std::string& name,
           Plot plot,
           std::vector<NamedPlot>* plots) const {
    std::string file;
    for (const char c : group_ + "_" + name) {
      file += std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
    }
    plots->push_back({file, group_, std::move(plot)});
  }

  const AblationPlan& plan_;
  const std::vector<RunResult>& runs_;
  const std::string group_;
};

}  // namespace

Curve MeanCurve(const std::vector<Curve>& curves) {
  if (curves.size() == 1) return curves[0];
  Curve mean;
  for (const Curve& curve : curves) {
    mean.x.insert(mean.x.end(), curve.x.begin(), curve.x.end());
  }
  std::sort(mean.x.begin(), mean.x.end());
  mean.x.erase(std::unique(mean.x.begin(), mean.x.end()), mean.x.end());
  for (const double x : mean.x) {
    double sum = 0;
    for (const Curve& curve : curves) sum += ValueAt(curve, x);
    mean.y.push_back(sum / static_cast<double>(curves.size()));
  }
  return mean;
}

std::vector<NamedPlot> MakePlots(const AblationPlan& plan,
                                 const std::vector<RunResult>& runs) {
  std::vector<NamedPlot> plots;
  for (const std::string& group : GroupsOf(plan)) {
    GroupPlots(plan, runs, group).AddTo(&plots);
  }
  return plots;
}

}  // namespace facet
