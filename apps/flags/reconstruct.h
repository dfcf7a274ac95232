// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// All flags of facet-reconstruct. Defaults come from the options structs.
#pragma once

#include <string>

#include "pipeline/config.h"

namespace facet {

// Throws OptionsError naming the flag.
ReconstructOptions ReconstructOptionsFromFlags();

// Flags of a profile, one a line; "" for the default one. Throws OptionsError
// listing the profiles.
std::string ProfileFlags(const std::string& name);

}  // namespace facet
