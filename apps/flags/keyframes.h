// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Flags of the choice of keyframes.
#pragma once

#include "rgbd/keyframes.h"

namespace facet {

// From --keyframe_window and the flags of apps/flags/holdout.h. Throws
// OptionsError for values out of range.
KeyframeOptions KeyframeOptionsFromFlags();

}  // namespace facet
