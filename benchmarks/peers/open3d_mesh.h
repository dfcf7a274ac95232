// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// A mesh in Open3D's form, without colours.
#pragma once

#include <open3d/geometry/TriangleMesh.h>

#include "mesh/tri_mesh.h"

namespace facet {

inline open3d::geometry::TriangleMesh ToOpen3d(const TriMesh& mesh) {
  open3d::geometry::TriangleMesh peer;
  peer.vertices_.assign(mesh.vertices.begin(), mesh.vertices.end());
  peer.triangles_.reserve(mesh.NumFaces());
  for (const std::array<int, 3>& face : mesh.faces) {
    peer.triangles_.emplace_back(face[0], face[1], face[2]);
  }
  return peer;
}

}  // namespace facet
