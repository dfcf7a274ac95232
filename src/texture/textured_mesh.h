// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// A mesh with a texture atlas: what export, previews and evaluation share.
#pragma once

#include <Eigen/Core>
#include <array>
#include <opencv2/core.hpp>
#include <vector>

#include "mesh/tri_mesh.h"

namespace facet {

struct TexturedMesh {
  TriMesh mesh;
  std::vector<int> face_plane;  // empty, or plane id of every face
  // Texture coordinates of each corner in **pixels** of its page: x right, y
  // down, the centre of the texel in column j and row i is (j + 0.5, i + 0.5).
  // Empty: the mesh is vertex-coloured.
  std::vector<std::array<Eigen::Vector2f, 3>> face_uv;
  std::vector<int> face_page;  // page index of every face
  std::vector<cv::Mat> pages;  // CV_8UC3, RGB order
};

// RGB (0-255) at barycentrics (1-u-v, u, v) of a face: bilinear texture lookup,
// or interpolated vertex colours when there is no texture. Texel centres are at
// +0.5 as above; lookups are clamped to the page.
Eigen::Vector3f ColorAt(const TexturedMesh& model, int face, float u, float v);

}  // namespace facet
