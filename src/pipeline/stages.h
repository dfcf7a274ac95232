// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The stages of facet-reconstruct, in order. Each leaves an artefact in
// RUN/stages from which a later run can go on.
#pragma once

#include <string>
#include <vector>

namespace facet {

enum class Stage {
  kPartition,    // dense mesh -> planar clusters -> planes
  kSimplify,     // -> light mesh
  kKeyframes,    // colour images -> keyframes
  kPhotometric,  // texels, visibility, E_tex -> poses, planes, warps
  kGeometry,     // -> final vertices
  kExport,       // final colours, files, previews, report
};
inline constexpr int kNumStages = 6;

const char* StageName(Stage stage);

// Throws OptionsError listing the names. `flag` is named in the message.
Stage ParseStage(const std::string& flag, const std::string& name);

}  // namespace facet
