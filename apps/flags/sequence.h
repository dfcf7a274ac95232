// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Flags of the input scan, shared by all programs.
#pragma once

#include <gflags/gflags_declare.h>

#include <memory>

#include "rgbd/sequence.h"

DECLARE_string(sequence);

namespace facet {

// From --pose_camera, --extrinsic_direction, --min_depth, --max_depth. Throws
// OptionsError naming the flag and its choices.
SequenceOptions SequenceOptionsFromFlags();

// Opens --sequence. Throws OptionsError if the flag is empty, and what
// OpenSequence throws.
std::unique_ptr<RgbdSequence> OpenSequenceFromFlags(
    const SequenceOptions& options = SequenceOptionsFromFlags());

}  // namespace facet
