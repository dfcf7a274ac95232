// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "pipeline/stages.h"

#include "util/errors.h"

namespace facet {

const char* StageName(Stage stage) {
  static const char* const kNames[kNumStages] = {"partition",
                                                 "simplify",
                                                 "keyframes",
                                                 "photometric",
                                                 "geometry",
                                                 "export"};
  return kNames[static_cast<int>(stage)];
}

Stage ParseStage(const std::string& flag, const std::string& name) {
  std::string choices;
  for (int s = 0; s < kNumStages; ++s) {
    if (name == StageName(static_cast<Stage>(s))) return static_cast<Stage>(s);
    choices +=
        (s > 0 ? ", " : "") + std::string(StageName(static_cast<Stage>(s)));
  }
  throw OptionsError("--" + flag + "=" + name + " is no stage: use one of " +
                     choices);
}

}  // namespace facet
