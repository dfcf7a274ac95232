// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Wavefront OBJ with MTL and PNG textures (method, Sec. 9.1).
#pragma once

#include <string>
#include <vector>

#include "texture/textured_mesh.h"

namespace facet {

// Writes mesh.obj, mesh.mtl and texture_0.png, texture_1.png, ... into `dir`,
// each atomically, the OBJ last. vt = (x / W, 1 - y / H); faces are grouped by
// page (usemtl) in ascending order, names are relative. Without texture
// coordinates only mesh.obj with bare geometry. Throws InputError when `dir`
// cannot be written.
// `pages` as from EncodePages (texture/seam_vertices.h).
void ExportObj(const std::string& dir,
               const TexturedMesh& model,
               const std::vector<std::string>& pages);

}  // namespace facet
