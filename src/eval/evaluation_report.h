// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// What facet-evaluate found out about one model, as JSON and as table rows.
// Figures that do not exist (NaN) are null in JSON and "-" in tables.
#pragma once

#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "eval/mesh_distance.h"
#include "eval/model_evaluation.h"
#include "eval/plane_metrics.h"
#include "eval/trajectory_error.h"
#include "mesh/mesh_checks.h"

namespace facet {

// Errors at one state of a run (eval/trace_states.h); NaN = not measured.
struct TraceErrors {
  double ate_m = std::numeric_limits<double>::quiet_NaN();  // of the keyframes
  double rotation_deg = std::numeric_limits<double>::quiet_NaN();
  // Means over the planes by area.
  double plane_angle_deg = std::numeric_limits<double>::quiet_NaN();
  double plane_offset_m = std::numeric_limits<double>::quiet_NaN();
};

struct ModelReport {
  std::string model;        // path as given
  std::string pose_source;  // where the poses of the frames come from
  size_t vertices = 0, faces = 0;
  bool textured = false;  // false: vertex colours or none
  MeshChecks checks;
  std::optional<ModelEvaluation> photometric;
  std::optional<MeshDistance> distance;
  std::optional<TrajectoryError> trajectory;
  std::optional<TrajectoryError> input_trajectory;  // of the sequence's poses
  std::optional<PlaneMetrics> planes, initial_planes;
  std::vector<TraceErrors> trace;
};

nlohmann::json ToJson(const ModelReport& report);

// Fixed-width tables, one row a model; only those that any model has.
std::string FormatTables(const std::vector<ModelReport>& reports);

}  // namespace facet
