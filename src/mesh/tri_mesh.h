// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The triangle mesh that crosses layers: two flat arrays.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <vector>

namespace facet {

using Rgb = std::array<uint8_t, 3>;

struct TriMesh {
  std::vector<Eigen::Vector3d> vertices;  // [m]
  std::vector<std::array<int, 3>> faces;  // counter-clockwise from outside
  std::vector<Rgb> vertex_colors;         // empty, or one a vertex

  size_t NumVertices() const { return vertices.size(); }
  size_t NumFaces() const { return faces.size(); }

  // (v1 - v0) x (v2 - v0): twice the area, along the face normal [m^2].
  Eigen::Vector3d FaceCross(size_t face) const {
    const auto& f = faces[face];
    return (vertices[f[1]] - vertices[f[0]])
        .cross(vertices[f[2]] - vertices[f[0]]);
  }
  double FaceArea(size_t face) const { return 0.5 * FaceCross(face).norm(); }
  Eigen::Vector3d FaceCentroid(size_t face) const {
    const auto& f = faces[face];
    return (vertices[f[0]] + vertices[f[1]] + vertices[f[2]]) / 3.0;
  }
};

}  // namespace facet
