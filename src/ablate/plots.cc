// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "ablate/plots.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "ablate/comparison.h"
#include "ablate/tables.h"

namespace facet {
namespace {

// Something that changes along a trace.
struct Quantity {
  const char* name;  // part of the file name
  const char* title;
  const char* y_label;
  bool energy;  // exists for runs with the same energy, on the finest level
  double (*value)(const TracePoint& point,
                  const TracePoint& start,
                  double best);  // lowest E_tex of all comparable runs
};

using Point = TracePoint;

const Quantity kQuantities[] = {
    {"E_tex",
     "E_tex",
     "E_tex / E_tex(0)",
     true,
     [](const Point& p, const Point& start, double) {
       return p.e_tex / start.e_tex;
     }},
    {"E_c",
     "E_c",
     "E_c / E_c(0)",
     true,
     [](const Point& p, const Point& start, double) {
       return p.e_c / start.e_c;
     }},
    {"gap",
     "energy left to gain",
     "(E_tex - E_best) / (E_tex(0) - E_best)",
     true,
     [](const Point& p, const Point& start, double best) {
       // The best variant ends at 0, which has no logarithm.
       return std::max(1e-4, (p.e_tex - best) / (start.e_tex - best));
     }},
    {"ate",
     "ATE of the keyframes",
     "ATE [mm]",
     false,
     [](const Point& p, const Point&, double) { return p.ate_mm; }},
    {"plane_angle",
     "plane angles against the truth",
     "mean error [deg]",
     false,
     [](const Point& p, const Point&, double) { return p.plane_angle_deg; }},
    {"plane_offset",
     "plane offsets against the truth",
     "mean error [mm]",
     false,
     [](const Point& p, const Point&, double) { return p.plane_offset_mm; }},
};

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
Curve CurveOf(const RunResult& run,
              const std::vector<RunResult>& runs,
              const Quantity& quantity,
              bool against_time) {
  Curve curve;
  if (quantity.energy && !run.same_energy) return curve;
  const double best = BestEnergy(run, runs);
  for (const TracePoint& point : run.trace) {
    if (quantity.energy && point.level > 0) continue;
    const double y = quantity.value(point, run.trace[0], best);
    if (!std::isfinite(y)) continue;
    const double x = against_time ? point.cpu_s : point.iterations;
    // Of phases without iterations the last one counts.
    if (curve.x.size() > 1 && curve.x.back() >= x) {
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
      for (const Quantity& quantity : kQuantities) {
        Add(quantity, against_time, plots);
      }
    }
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

  void Add(const Quantity& quantity,
           bool against_time,
           std::vector<NamedPlot>* plots) const {
    Plot plot;
    plot.title = group_ + ": " + quantity.title;
    plot.y_label = quantity.y_label;
    plot.x_label = against_time ? "CPU time [s]"
                                : "iterations (mean over a phase's problems)";
    if (quantity.name == std::string("gap")) {
      plot.log_y = true;
      plot.level = 0.01;
      plot.level_label = "99 % reached";
    }
    for (size_t v = 0; v < plan_.variants.size(); ++v) {
      std::vector<Curve> curves;
      for (const RunResult* run : RunsOf(v)) {
        Curve curve = CurveOf(*run, runs_, quantity, against_time);
        if (!curve.x.empty()) curves.push_back(std::move(curve));
      }
      if (curves.empty()) continue;
      PlotLine line;
      line.label = plan_.variants[v].label;
      line.index = v;
      line.markers = curves.size() == 1;
      Curve mean = MeanCurve(curves);
      line.x = std::move(mean.x);
      line.y = std::move(mean.y);
      plot.lines.push_back(std::move(line));
    }
    if (plot.lines.empty()) return;
    std::string file;
    for (const char c : group_ + "_" + quantity.name) {
      file += std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
    }
    plots->push_back({file + (against_time ? "_time" : "_iterations"),
                      group_,
                      std::move(plot)});
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
