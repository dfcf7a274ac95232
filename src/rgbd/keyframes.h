// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Keyframes: the sharpest frame of each window of consecutive frame numbers
// (paper, Sec. 3.3; method ch. 5).
#pragma once

#include <vector>

#include "rgbd/sequence.h"

namespace facet {

struct KeyframeOptions {
  // Frame numbers [k w, (k+1) w) form window k. Paper: 5 or 10.
  int window = 5;
  // Frames whose number equals `holdout_offset` modulo `holdout_stride` are
  // never used for mapping. 0 = none.
  int holdout_stride = 0;
  int holdout_offset = 0;
};

// Is the frame kept away from mapping?
bool IsHeldOut(int frame_number, const KeyframeOptions& options);

// Indices into sequence.frames(), ascending. Usable frames only; ties go to the
// lower number. `blur`, if given, receives the Crete blur of every frame read
// (NaN for others), by frame index. Frames whose colour, or whose depth as a
// keyframe, does not decode are skipped and counted in a warning. Throws
// InputError if these are more than 20 %, UnsolvableError if no keyframe
// remains.
std::vector<int> SelectKeyframes(const RgbdSequence& sequence,
                                 const KeyframeOptions& options,
                                 std::vector<double>* blur = nullptr);

}  // namespace facet
