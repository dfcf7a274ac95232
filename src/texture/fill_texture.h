// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// From colours of texels to complete pages: unseen texels and gutters (method,
// Sec. 4.6).
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <opencv2/core.hpp>
#include <vector>

#include "mesh/tri_mesh.h"
#include "texture/atlas.h"
#include "texture/bake_texels.h"

namespace facet {

// Fills pixels whose weight is 0 from those with weight > 0 by push-pull:
// averages over ever larger blocks, then interpolated back. Row-major
// width x height; returns false if there is no pixel to start from.
bool PushPull(int width,
              int height,
              const std::vector<float>& weight,
              std::vector<Eigen::Vector3f>* color);

// Colours (0-255) of all vertices: those of the mesh if it has any, else means
// of the seen texels of their faces, carried on along edges to vertices
// without.
std::vector<Eigen::Vector3f> VertexBaseColors(
    const TriMesh& mesh,
    const BakeTexels& texels,
    const std::vector<uint8_t>& seen,
    const std::vector<Eigen::Vector3f>& colors);

// Writes the texels to pages, CV_8UC3 RGB. With `inpaint`, unseen texels get
// the interpolated vertex colours plus the push-pulled difference between the
// seen texels around them and those; `colors` is updated. The rest of each
// gutter copies its nearest texel.
std::vector<cv::Mat> FillPages(const TriMesh& mesh,
                               const Atlas& atlas,
                               const BakeTexels& texels,
                               const std::vector<uint8_t>& seen,
                               bool inpaint,
                               std::vector<Eigen::Vector3f>* colors);

// A page: CV_8U, 255 where a texel of a face is not seen.
std::vector<cv::Mat> UnseenMask(const Atlas& atlas,
                                const BakeTexels& texels,
                                const std::vector<uint8_t>& seen);

}  // namespace facet
