// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The parsers behind ReadMesh (mesh/mesh_io.h), one a format. Internal.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "mesh/mesh_io.h"

namespace facet {

// `content` is the whole file, `path` only names it in errors.
MeshFile ParsePly(const std::string& path, const std::string& content);
MeshFile ParseObj(const std::string& path, const std::string& content);

// Appends polygon[0], polygon[k], polygon[k + 1] for every k: the fan of a
// polygon. Fewer than three corners append nothing; returns the triangles made.
int AppendFan(const std::vector<int>& polygon,
              std::vector<std::array<int, 3>>* faces);

// A value of a file as a colour byte; NaN is black.
uint8_t ColorByte(double value);

}  // namespace facet
