// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Keyframes: the sharpest frame of each window of consecutive frame numbers
// (paper, Sec. 3.3; method ch. 5).
#pragma once

#include <cstddef>
#include <string>
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

struct KeyframeChoice {
  std::vector<int> keyframes;  // indices into sequence.frames(), ascending
  std::vector<double> blur;    // Crete blur by frame index, NaN = not measured
  size_t tried = 0;            // frames read
  std::vector<std::string> problems;  // of those that do not decode: skipped
};

// Usable frames only; ties go to the lower number. Frames whose colour, or
// whose depth as a keyframe, does not decode are skipped. Warns of nothing and
// writes nothing, so it may run beside other work. Throws OptionsError.
KeyframeChoice ChooseKeyframes(const RgbdSequence& sequence,
                               const KeyframeOptions& options);

// Warns of the frames that were skipped. Throws InputError if these are more
// than 20 %, UnsolvableError if there is no keyframe.
void CheckKeyframes(const RgbdSequence& sequence, const KeyframeChoice& choice);

// Both in one: the keyframes.
std::vector<int> SelectKeyframes(const RgbdSequence& sequence,
                                 const KeyframeOptions& options);

}  // namespace facet
