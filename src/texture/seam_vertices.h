// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Vertices split where texture coordinates jump, as file formats want them.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "texture/textured_mesh.h"

namespace facet {

// A mesh vertex with one pair of texture coordinates.
struct SeamVertex {
  int vertex = 0;  // of the mesh
  int page = 0;
  Eigen::Vector2f uv = Eigen::Vector2f::Zero();  // page px
};

struct SeamVertices {
  std::vector<SeamVertex> vertices;         // in order of first use by a face
  std::vector<std::array<int, 3>> corners;  // into vertices, by face
};

// Corners with the same vertex, page and coordinates share one entry. Without
// texture coordinates all are (0, 0) on page 0.
SeamVertices SplitAtSeams(const TexturedMesh& model);

// The pages (CV_8UC3, RGB) as bytes of PNG files; fast compression.
std::vector<std::string> EncodePages(const TexturedMesh& model);

}  // namespace facet
