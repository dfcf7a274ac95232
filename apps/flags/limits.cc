// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "apps/flags/limits.h"

#include <gflags/gflags.h>

#include <cstdio>
#include <cstdlib>

#include "util/errors.h"

namespace facet {
namespace {

std::string RangeText(const FlagLimit& limit) {
  char text[100];
  if (limit.high == std::numeric_limits<double>::max()) {
    std::snprintf(text,
                  sizeof(text),
                  "%s %g",
                  limit.low_open ? "greater than" : "at least",
                  limit.low);
  } else {
    std::snprintf(text,
                  sizeof(text),
                  "%s %g and %s %g",
                  limit.low_open ? "greater than" : "at least",
                  limit.low,
                  limit.high_open ? "less than" : "at most",
                  limit.high);
  }
  return text;
}

}  // namespace

void CheckFlagLimits(const std::vector<FlagLimit>& limits) {
  for (const FlagLimit& limit : limits) {
    const std::string text =
        gflags::GetCommandLineFlagInfoOrDie(limit.flag).current_value;
    const double value = std::strtod(text.c_str(), nullptr);
    const bool low_ok = limit.low_open ? value > limit.low : value >= limit.low;
    const bool high_ok =
        limit.high_open ? value < limit.high : value <= limit.high;
    if (low_ok && high_ok) continue;
    throw OptionsError(std::string("--") + limit.flag + "=" + text +
                       " is out of range: it must be " + RangeText(limit));
  }
}

}  // namespace facet
