// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "apps/flags/holdout.h"

#include <gflags/gflags.h>

#include "util/errors.h"

DEFINE_int32(holdout_stride,
             facet::KeyframeOptions().holdout_stride,
             "frames whose number equals --holdout_offset modulo this are "
             "never used for mapping; 0 = none");
DEFINE_int32(holdout_offset,
             facet::KeyframeOptions().holdout_offset,
             "see --holdout_stride");

namespace facet {

void HoldoutFromFlags(KeyframeOptions* options) {
  if (FLAGS_holdout_stride < 0 || FLAGS_holdout_offset < 0) {
    throw OptionsError(
        "--holdout_stride and --holdout_offset must not be negative");
  }
  options->holdout_stride = FLAGS_holdout_stride;
  options->holdout_offset = FLAGS_holdout_offset;
}

}  // namespace facet
