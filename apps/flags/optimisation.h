// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Flags of the photometric optimisation: schedule, weights, gauge, formulation.
#pragma once

#include "pipeline/photometric_stage.h"

namespace facet {

// Throws OptionsError naming the flag. Leaves alone what has no flag here.
void OptimisationOptionsFromFlags(PhotometricOptions* options);

}  // namespace facet
