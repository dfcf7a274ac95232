// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// facet-reconstruct as a function: runs the stages, writes the run folder
// (docs/formats.md), returns the report.
#pragma once

#include <nlohmann/json.hpp>

#include "pipeline/config.h"

namespace facet {

// Throws OptionsError with the reason if options contradict each other: what
// Reconstruct refuses before it reads anything.
void CheckOptions(const ReconstructOptions& options);

// Throws OptionsError, InputError, UnsolvableError. Files of the run folder
// appear atomically; report.json comes last.
nlohmann::json Reconstruct(const ReconstructOptions& options);

}  // namespace facet
