// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "ablate/run_result.h"

#include <glog/logging.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "util/atomic_file.h"
#include "util/errors.h"

namespace facet {
namespace {

using nlohmann::json;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

json ParseFile(const std::string& path) {
  try {
    return json::parse(ReadFile(path));
  } catch (const json::exception& e) {
    throw InputError(path + " is damaged: delete its folder and run again (" +
                     e.what() + ")");
  }
}

double NumberAt(const json& document, const std::string& pointer) {
  const json::json_pointer at(pointer);
  if (!document.contains(at) || !document[at].is_number()) return kNone;
  return document[at];
}

std::vector<std::string> SplitCells(const std::string& line) {
  std::vector<std::string> cells;
  std::stringstream stream(line);
  for (std::string cell; std::getline(stream, cell, ',');) {
    cells.push_back(cell);
  }
  return cells;
}

std::vector<TracePoint> ReadTrace(const std::string& path) {
  std::stringstream lines(ReadFile(path));
  std::string line;
  std::getline(lines, line);
  std::map<std::string, size_t> column;
  const std::vector<std::string> heads = SplitCells(line);
  for (size_t i = 0; i < heads.size(); ++i) column[heads[i]] = i;
  for (const char* needed : {"level",
                             "round",
                             "phase",
                             "E_c",
                             "E_p_m2",
                             "E_s_px2",
                             "E_tex",
                             "rms_grey_255",
                             "problems",
                             "iterations",
                             "wall_s",
                             "cpu_s"}) {
    if (column.count(needed) > 0) continue;
    throw InputError(path + " has no column " + needed +
                     ": it is of another version of facet");
  }
  std::vector<TracePoint> trace;
  double iterations = 0;
  while (std::getline(lines, line)) {
    const std::vector<std::string> cells = SplitCells(line);
    if (cells.size() != heads.size()) {
      throw InputError(path + " is damaged: delete its folder and run again");
    }
    const auto number = [&](const char* head) {
      return std::strtod(cells[column[head]].c_str(), nullptr);
    };
    const double problems = number("problems");
    if (problems > 0) iterations += number("iterations") / problems;
    TracePoint point;
    point.level = static_cast<int>(number("level"));
    point.ate_mm = point.plane_angle_deg = point.plane_offset_mm = kNone;
    point.round = static_cast<int>(number("round"));
    point.phase = cells[column["phase"]];
    point.e_c = number("E_c");
    point.e_p = number("E_p_m2");
    point.e_s = number("E_s_px2");
    point.e_tex = number("E_tex");
    point.rms_grey = number("rms_grey_255");
    point.iterations = iterations;
    point.wall_s = number("wall_s");
    point.cpu_s = number("cpu_s");
    trace.push_back(point);
  }
  if (trace.empty()) throw InputError(path + " has no rows");
  return trace;
}

// The errors of every line of the trace, if the run kept its states.
void AddTraceErrors(const json& evaluation, std::vector<TracePoint>* trace) {
  if (!evaluation.is_object() || !evaluation.contains("trace")) return;
  const json& errors = evaluation["trace"];
  if (errors.size() != trace->size()) return;
  for (size_t i = 0; i < errors.size(); ++i) {
    TracePoint& point = (*trace)[i];
    point.ate_mm = NumberAt(errors[i], "/ate_mm");
    point.plane_angle_deg = NumberAt(errors[i], "/plane_angle_deg");
    point.plane_offset_mm = NumberAt(errors[i], "/plane_offset_mm");
  }
}

}  // namespace

const std::vector<Figure>& Figures() {
  constexpr Comparable kAlways = Comparable::kAlways;
  constexpr Comparable kObservations = Comparable::kSameObservations;
  constexpr Comparable kEnergy = Comparable::kSameEnergy;
  static const auto* const kFigures = new std::vector<Figure>{
      {"texels", "", kAlways, "/texels"},
      {"observations", "", kAlways, "/observations"},
      {"lambda1", "", kAlways, "/lambda1"},
      {"lambda2", "", kAlways, "/options/photometric/lambda2"},
      {"E_tex_initial", "", kEnergy, "/energy/initial/E_tex"},
      {"E_c_initial", "", kEnergy, "/energy/initial/E_c"},
      {"E_p_initial", "", kEnergy, "/energy/initial/E_p"},
      {"E_s_initial", "", kEnergy, "/energy/initial/E_s"},
      {"E_tex", "E_tex", kEnergy, "/energy/final/E_tex"},
      {"E_c", "E_c", kEnergy, "/energy/final/E_c"},
      {"E_p", "", kEnergy, "/energy/final/E_p"},
      {"E_s", "", kEnergy, "/energy/final/E_s"},
      {"rms_grey_initial", "", kObservations, "/energy/initial/rms_grey"},
      {"rms_grey", "rms grey", kObservations, "/energy/final/rms_grey"},
      {"cpu_s", "CPU [s]", kAlways, "", Figure::kComputed},
      {"wall_s", "", kAlways, "", Figure::kComputed},
      {"cpu_s_to_99", "CPU to 99 % [s]", kEnergy, "", Figure::kComputed},
      {"cpu_s_to_reference", "", kEnergy, "", Figure::kComputed},
      {"speedup_to_reference", "speed-up", kEnergy, "", Figure::kComputed},
      {"run_cpu_s", "", kAlways, "", Figure::kComputed},
      {"run_wall_s", "", kAlways, "", Figure::kComputed},
      {"phases_undone", "", kAlways, "/phases/undone"},
      {"slide_mm", "slide [mm]", kAlways, "/slide/mm"},
      {"ate_input_mm",
       "",
       kAlways,
       "/input_trajectory/ate_mm/rmse",
       Figure::kEvaluation},
      {"ate_mm",
       "ATE [mm]",
       kAlways,
       "/trajectory/ate_mm/rmse",
       Figure::kEvaluation},
      {"rotation_deg",
       "rotation [deg]",
       kAlways,
       "/trajectory/rotation_deg/rmse",
       Figure::kEvaluation},
      {"rpe_frame_mm",
       "RPE [mm]",
       kAlways,
       "/trajectory/rpe_frame_mm/rmse",
       Figure::kEvaluation},
      {"rpe_second_mm",
       "",
       kAlways,
       "/trajectory/rpe_second_mm/rmse",
       Figure::kEvaluation},
      {"plane_angle_input_deg",
       "",
       kAlways,
       "/initial_planes/angle_deg/mean",
       Figure::kEvaluation},
      {"plane_angle_deg",
       "plane angle [deg]",
       kAlways,
       "/planes/angle_deg/mean",
       Figure::kEvaluation},
      {"plane_offset_input_mm",
       "",
       kAlways,
       "/initial_planes/offset_mm/mean",
       Figure::kEvaluation},
      {"plane_offset_mm",
       "plane offset [mm]",
       kAlways,
       "/planes/offset_mm/mean",
       Figure::kEvaluation},
      {"psnr_aligned_db",
       "PSNR [dB]",
       kAlways,
       "/photometric/psnr_aligned",
       Figure::kPhotos},
      {"gradient_ncc",
       "gradient NCC",
       kAlways,
       "/photometric/gradient_ncc",
       Figure::kPhotos},
      {"gradient_energy",
       "",
       kAlways,
       "/photometric/gradient_energy",
       Figure::kPhotos},
  };
  return *kFigures;
}

size_t FigureIndex(const std::string& column) {
  const std::vector<Figure>& figures = Figures();
  for (size_t i = 0; i < figures.size(); ++i) {
    if (figures[i].column == column) return i;
  }
  LOG(FATAL) << "no figure " << column;
  return 0;
}

double RunResult::Missing() { return kNone; }

double RunResult::Compared(size_t figure) const {
  if (figures.empty()) return kNone;
  switch (Figures()[figure].comparable) {
    case Comparable::kAlways:
      break;
    case Comparable::kSameObservations:
      if (!same_observations) return kNone;
      break;
    case Comparable::kSameEnergy:
      if (!same_energy) return kNone;
      break;
  }
  return figures[figure];
}

void ReadRun(const std::string& folder, bool held_out, RunResult* result) {
  const json report = ParseFile(folder + "/report.json");
  json evaluation;
  if (std::filesystem::exists(folder + "/evaluation.json")) {
    evaluation = ParseFile(folder + "/evaluation.json")["models"][0];
  }
  result->fingerprint = report.value("observation_fingerprint", "");
  if (result->fingerprint.empty()) {
    throw InputError(folder +
                     "/report.json has no observation_fingerprint: it is of "
                     "another version of facet, delete the folder and run "
                     "again");
  }
  result->trace = ReadTrace(folder + "/trace.csv");
  AddTraceErrors(evaluation, &result->trace);
  result->figures.clear();
  for (const Figure& figure : Figures()) {
    double value = kNone;
    if (figure.source == Figure::kReport) {
      value = NumberAt(report, figure.pointer);
    } else if (figure.source == Figure::kEvaluation ||
               (figure.source == Figure::kPhotos && held_out)) {
      value = NumberAt(evaluation, figure.pointer);
    }
    result->figures.push_back(value);
  }
  result->figures[FigureIndex("cpu_s")] = result->trace.back().cpu_s;
  result->figures[FigureIndex("wall_s")] = result->trace.back().wall_s;
  result->problem.clear();
}

}  // namespace facet
