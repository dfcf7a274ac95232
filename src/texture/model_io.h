// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Reading finished models, facet's own and those of other programs, for
// evaluation and previews. Writing them is texture/export's job.
#pragma once

#include <string>

#include "texture/textured_mesh.h"

namespace facet {

// Reads
//   a folder   its mesh.obj (a run folder of facet-reconstruct);
//   *.obj      v (with three colour numbers after x y z, if any), vt, f with
//   any
//              index form, usemtl, mtllib with map_Kd and Kd, g plane_<id>;
//   *.ply      vertices, faces, vertex colours, plane_id (mesh/mesh_io.h).
// The origin of vt is the lower left corner of the image: x = u W, y = (1-v) H
// page pixels. Faces that lie beyond the image in vt (tiled textures) are moved
// into it as a whole. Faces without an image get a one-texel page of their
// material's Kd (grey without one).
//
// A mesh with neither image nor vertex colours comes back without both
// (HasColor is false). Polygons are cut into fans. Throws InputError naming
// file and line: missing, malformed, indices out of range, not finite, no
// faces, a texture that does not decode.
TexturedMesh LoadModel(const std::string& path);

// Can ColorAt be asked?
bool HasColor(const TexturedMesh& model);

}  // namespace facet
