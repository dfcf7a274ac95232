// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// What facet-evaluate found out about one model, as JSON and as table rows.
// Figures that do not exist (NaN) are null in JSON and "-" in tables.
#pragma once

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
};

nlohmann::json ToJson(const ModelReport& report);

// Fixed-width tables, one row a model; only those that any model has.
std::string FormatTables(const std::vector<ModelReport>& reports);

}  // namespace facet
