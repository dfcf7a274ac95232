// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// From a polygon soup to a mesh that the stages can rely on. Method, Sec. 1.7.
#pragma once

#include <cstddef>
#include <string>

#include "mesh/tri_mesh.h"

namespace facet {

struct CleanOptions {
  // Vertices that round to the same point of a grid of this size become one;
  // 0 welds only exactly equal ones. >= 0 [m].
  double weld_tolerance_m = 0;
  // Faces with less area are dropped. >= 0 [m^2].
  double min_face_area_m2 = 1e-14;
  // Pieces (connected through vertices) with fewer faces are dropped, unless
  // none is larger; 0 keeps all. Floating specks of a fused scan are of this
  // kind.
  int min_component_faces = 20;
  // A bounding box with a diagonal outside this range raises a warning: is the
  // mesh in metres? [m].
  double min_diagonal_m = 0.2, max_diagonal_m = 500;
};

// What was removed, by kind; every face is counted once, under the first kind
// in this order that applies.
struct CleanReport {
  size_t non_finite_vertices = 0;
  size_t bad_index_faces = 0;       // an index outside the vertices
  size_t non_finite_faces = 0;      // a corner is not finite
  size_t welded_vertices = 0;       // became another, equal vertex
  size_t repeated_index_faces = 0;  // a vertex twice (after welding)
  size_t zero_area_faces = 0;
  size_t duplicate_faces = 0;  // same three vertices, in any order
  size_t small_components = 0;
  size_t small_component_faces = 0;
  size_t unreferenced_vertices = 0;
  double diagonal_m = 0;  // of the bounding box of the result

  size_t RemovedFaces() const {
    return bad_index_faces + non_finite_faces + repeated_index_faces +
           zero_area_faces + duplicate_faces + small_component_faces;
  }
  // One sentence, e.g. "removed 4 faces without area and 12 unreferenced
  // vertices"; "nothing to clean" if so.
  std::string Summary() const;
};

// Cleans in place; the order of what stays is kept. Broken faces (bad indices,
// not finite, no area, duplicates) raise one counted warning. Throws
// OptionsError for negative options, InputError when no face is left.
CleanReport CleanMesh(const CleanOptions& options, TriMesh* mesh);

struct SplitReport {
  size_t non_manifold_edges = 0;  // of more than two faces, or two that run
                                  // along it in the same direction
  size_t split_vertices = 0;      // had more than one fan of faces
  size_t added_vertices = 0;
};

// Makes every edge and vertex manifold and every half-edge unique by giving
// each fan of faces its own copy of the vertex. Faces keep their order and
// corners; nothing moves. Where more than two faces meet in an edge, those that
// bound the same solid wedge stay joined if orientation and fans allow it, else
// the edge opens. Method, Sec. 1.7. The mesh must be clean.
SplitReport SplitNonManifold(TriMesh* mesh);

}  // namespace facet
