// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Ranges of numeric flags, checked before any work: the libraries check theirs
// again, but only when their stage begins, and do not know the flags' names.
#pragma once

#include <limits>
#include <string>
#include <vector>

namespace facet {

// The values that a flag may have: low <= value <= high, without the ends that
// are open. NaN lies in no range.
struct FlagLimit {
  const char* flag;
  double low;
  double high = std::numeric_limits<double>::max();
  bool low_open = false, high_open = false;
};

// Throws OptionsError naming the first flag outside its range, and the range.
void CheckFlagLimits(const std::vector<FlagLimit>& limits);

}  // namespace facet
