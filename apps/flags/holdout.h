// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Flags of the frames kept away from mapping, for evaluation.
#pragma once

#include "rgbd/keyframes.h"

namespace facet {

// Fills holdout_stride and holdout_offset from the flags of these names. Throws
// OptionsError if one is negative.
void HoldoutFromFlags(KeyframeOptions* options);

}  // namespace facet
