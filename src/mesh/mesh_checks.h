// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Counts of what is wrong with a triangle mesh, and of its topology.
#pragma once

#include "mesh/planar_partition.h"
#include "mesh/tri_mesh.h"

namespace facet {

struct MeshChecks {
  int non_manifold_edges = 0;     // edges with more than two faces
  int non_manifold_vertices = 0;  // vertices whose faces form several fans
  int duplicate_faces = 0;        // faces over vertices of an earlier face
  int degenerate_faces = 0;       // repeated vertex, or area below 1e-12 m^2
  int isolated_vertices = 0;      // vertices without a face
  int boundary_edges = 0;         // edges with one face
  int boundary_loops = 0;         // connected sets of boundary edges
  int components = 0;             // sets of faces connected through edges
  int euler = 0;                  // V - E + F, isolated vertices not counted
};

MeshChecks CheckMesh(const TriMesh& mesh);

// Faces of positive area that look away from the plane of their cluster:
// n_face . n_cluster <= 0. Where a cluster stands for something round or noisy,
// such faces are part of its shape.
struct FlippedFaces {
  int count = 0;
  double area_share = 0;  // of the area of the mesh
};
FlippedFaces FindFlippedFaces(const TriMesh& mesh,
                              const PlanarPartition& partition);

}  // namespace facet
