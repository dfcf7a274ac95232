// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Binary glTF 2.0 with embedded textures (method, Sec. 9.2).
#pragma once

#include <string>
#include <vector>

#include "texture/textured_mesh.h"

namespace facet {

// One mesh with one primitive a page: POSITION, NORMAL (split at chart borders,
// so planes look flat), TEXCOORD_0 = (x / W, y / H), uint32 indices. Materials
// are unlit (KHR_materials_unlit: the light is in the colours) and
// double-sided. Coordinates stay those of the mesh, in metres. Written
// atomically. Without texture coordinates one primitive with bare geometry.
// Throws InputError when the file cannot be written, UnsolvableError beyond 4
// GB.
// `pages` as from EncodePages (texture/seam_vertices.h).
void ExportGlb(const std::string& path,
               const TexturedMesh& model,
               const std::vector<std::string>& pages);

}  // namespace facet
