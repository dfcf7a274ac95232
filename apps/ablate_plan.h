// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// From the flags of facet-ablate, which has all those of facet-reconstruct too,
// to a plan whose every run has been checked.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "ablate/plan.h"

namespace facet {

struct AblationFlags {
  std::string vary, design, output;
  std::string scans;  // file, may be empty
  std::vector<int> seeds;
  std::vector<double> noise_mm, noise_deg;
  std::string synthesize_flags, fuse_flags;
  int jobs = 1, threads = 0;
  bool allow_different_observations = false;
  // Flags that facet-reconstruct does not have.
  std::set<std::string> own_flags;
};

// Throws OptionsError and InputError: every combination is tried on the parser
// of facet-reconstruct, and must leave the stages before the photometric one as
// they are. The flags of the process are the base of all runs.
AblationPlan MakeAblationPlan(const AblationFlags& flags);

// "1,2.5" -> {1, 2.5}. Throws OptionsError naming the flag.
std::vector<double> ParseNumbers(const std::string& flag,
                                 const std::string& text);

}  // namespace facet
