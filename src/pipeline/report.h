// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Parts of report.json (docs/formats.md).
#pragma once

#include <nlohmann/json.hpp>

#include "eval/trajectory_error.h"
#include "pipeline/photometric_stage.h"
#include "problems/geometry_problem.h"

namespace facet {

nlohmann::json ToJson(const EnergyTerms& terms);

// texels, observations, visibility, lambda1, energy, slide.
nlohmann::json PhotometricReport(const PhotometricResult& result,
                                 const RigidMotion& slide);

nlohmann::json GeometryReport(const GeometrySummary& summary);

// versions (facet, libraries, compiler, kernel), machine, threads.
void AddEnvironment(nlohmann::json* report);

}  // namespace facet
