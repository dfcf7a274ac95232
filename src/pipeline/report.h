// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Parts of report.json (docs/formats.md).
#pragma once

#include <nlohmann/json.hpp>

#include "eval/trajectory_error.h"
#include "mesh/simplify.h"
#include "pipeline/photometric_stage.h"
#include "problems/geometry_problem.h"
#include "rgbd/keyframes.h"
#include "rgbd/sequence.h"

namespace facet {

nlohmann::json ToJson(const EnergyTerms& terms);

nlohmann::json SimplifyStageReport(const SimplifyReport& report);

// How many frames of which kind, and the frame numbers of the keyframes.
nlohmann::json KeyframeReport(const RgbdSequence& sequence,
                              const std::vector<int>& keyframes,
                              const KeyframeOptions& options);

// texels, observations, visibility, lambda1, energy, slide.
nlohmann::json PhotometricReport(const PhotometricResult& result,
                                 const RigidMotion& slide);

nlohmann::json GeometryReport(const GeometrySummary& summary);

// A resumed run reads images again, and warns of the same again.
std::vector<std::string> WithoutRepetitions(
    const std::vector<std::string>& warnings);

// versions (facet, libraries, compiler, kernel), machine, threads.
void AddEnvironment(nlohmann::json* report);

}  // namespace facet
