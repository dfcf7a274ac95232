// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The identity of a frozen set of texels and observations. Energies of two runs
// may be compared only if theirs are equal.
#pragma once

#include <string>

#include "texture/observations.h"
#include "texture/texels.h"

namespace facet {

// 16 hexadecimal digits that depend on every texel (position, plane, face, in
// order), on which texels each keyframe sees, and on nothing else.
std::string ObservationFingerprint(const TexelSet& texels,
                                   const Observations& observations);

}  // namespace facet
