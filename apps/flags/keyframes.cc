// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "apps/flags/keyframes.h"

#include <gflags/gflags.h>

#include "apps/flags/holdout.h"
#include "util/errors.h"

DEFINE_int32(keyframe_window,
             facet::KeyframeOptions().window,
             "the sharpest frame of each window of this many consecutive frame "
             "numbers becomes a keyframe; 1 = every frame");

namespace facet {

KeyframeOptions KeyframeOptionsFromFlags() {
  if (FLAGS_keyframe_window < 1) {
    throw OptionsError("--keyframe_window must be at least 1");
  }
  KeyframeOptions options;
  options.window = FLAGS_keyframe_window;
  HoldoutFromFlags(&options);
  return options;
}

}  // namespace facet
