// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#pragma once

#include <string>

namespace facet {

// Every formulation that can be varied, with its values, the one that holds
// without a flag, and its meaning: what facet-ablate --list prints.
std::string FormulationList();

}  // namespace facet
