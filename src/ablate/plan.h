// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// What an ablation does, decided and checked before anything is run.
#pragma once

#include <string>
#include <vector>

#include "ablate/matrix.h"
#include "ablate/scans.h"

namespace facet {

struct ScanPlan {
  ScanSpec spec;
  // Arguments of facet-synthesize and facet-fuse but for --output; synthetic
  // scans only.
  std::vector<std::string> synthesize_args, fuse_args;
  // Flags of facet-reconstruct, one --name=value a line, for the stages before
  // photometric, and text that changes if and only if their result does.
  std::string state_flags, state_settings;
  // Arguments of facet-evaluate but for --model and --output. Empty: neither
  // truth nor held-out frames.
  std::vector<std::string> evaluate_args;
  bool held_out = false;  // whether the evaluated photos were kept out
  // By variant: all flags of facet-reconstruct that bear on the result.
  std::vector<std::string> run_flags;
};

struct AblationPlan {
  std::string folder;    // of the ablation, absolute
  std::string programs;  // folder of facet-reconstruct and the others
  std::vector<VaryAxis> axes;
  std::vector<Variant> variants;
  std::vector<ScanPlan> scans;
  int jobs = 1, threads = 0;  // threads a job, 0 = one a core
  bool allow_different_observations = false;
};

}  // namespace facet
