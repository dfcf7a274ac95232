// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Mesh files: PLY (ascii, binary little and big endian, properties in any order
// and of any scalar type, polygons fan-triangulated, optional red/green/blue
// per vertex) and OBJ (v, f with v, v/vt, v//vn, v/vt/vn, negative indices).
// Method, Sec. 1.7. Faces come back as a polygon soup: nothing is checked but
// syntax and index syntax; clean with mesh/clean.h.
#pragma once

#include <string>
#include <vector>

#include "mesh/tri_mesh.h"

namespace facet {

// A mesh with what a PLY may carry beside it.
struct MeshFile {
  TriMesh mesh;
  std::vector<int> face_plane;  // property `int plane_id` a face; empty if none
};

// By extension (.ply, .obj). Throws InputError: missing, unreadable, truncated,
// malformed (with line or byte position), no vertices or no faces.
MeshFile ReadMesh(const std::string& path);

// Binary little-endian PLY: float32 vertices, uchar colours if the mesh has
// any, faces `list uchar int vertex_indices`; with `face_plane` also
// `int plane_id` and `uchar red green blue`, the colour of the plane
// (PlaneColor), a face. Written atomically.
void WritePly(const std::string& path,
              const TriMesh& mesh,
              const std::vector<int>* face_plane = nullptr);

// A bright colour that depends only on the id: the same plane has the same
// colour in every file and picture.
Rgb PlaneColor(int plane_id);

}  // namespace facet
