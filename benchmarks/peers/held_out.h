// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The frames that no tool may use for mapping, so that all are judged by photos
// they have not seen. scripts/bench gives facet-reconstruct the same numbers.
#pragma once

#include "rgbd/keyframes.h"

namespace facet {

// facet's keyframes, without the frames 7, 32, 57, ...
inline KeyframeOptions PeerKeyframes() {
  KeyframeOptions options;
  options.holdout_stride = 25;
  options.holdout_offset = 7;
  return options;
}

}  // namespace facet
