// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "mesh/mesh_checks.h"

#include <gtest/gtest.h>

#include "tests/mesh/plane_scenes.h"

namespace facet {
namespace {

// Breaks if a sound mesh is accused, or its topology is miscounted.
TEST(MeshChecks, SoundMeshes) {
  const MeshChecks cube = CheckMesh(MakeCube(3).mesh);
  EXPECT_EQ(cube.non_manifold_edges + cube.non_manifold_vertices +
                cube.duplicate_faces + cube.degenerate_faces +
                cube.isolated_vertices + cube.boundary_edges,
            0);
  EXPECT_EQ(cube.components, 1);
  EXPECT_EQ(cube.euler, 2);
  const MeshChecks sheet =
      CheckMesh(MakeSheet(3, [](double, double) { return 0.0; }).mesh);
  EXPECT_EQ(sheet.boundary_edges, 6 + 6 + 3 + 3);
  EXPECT_EQ(sheet.boundary_loops, 1);
  EXPECT_EQ(sheet.euler, 1);
}

// Breaks if one kind of defect is missed or takes another with it.
TEST(MeshChecks, FindsEachDefect) {
  TriMesh mesh;
  mesh.vertices = {{0, 0, 0},
                   {1, 0, 0},
                   {0, 1, 0},
                   {0, 0, 1},
                   {0, -1, 0},
                   {-1, 0, 0},
                   {0, -1, -1},
                   {9, 9, 9}};
  mesh.faces = {{0, 1, 2}};
  EXPECT_EQ(CheckMesh(mesh).isolated_vertices, 5);

  TriMesh fin = mesh;  // three faces at edge 0-1
  fin.faces.push_back({1, 0, 3});
  fin.faces.push_back({1, 0, 4});
  EXPECT_EQ(CheckMesh(fin).non_manifold_edges, 1);

  TriMesh bow_tie = mesh;  // two faces that share vertex 0 only
  bow_tie.faces.push_back({0, 5, 4});
  EXPECT_EQ(CheckMesh(bow_tie).non_manifold_vertices, 1);
  EXPECT_EQ(CheckMesh(bow_tie).components, 2);
  EXPECT_EQ(CheckMesh(bow_tie).non_manifold_edges, 0);

  TriMesh twice = mesh;
  twice.faces.push_back({2, 0, 1});
  EXPECT_EQ(CheckMesh(twice).duplicate_faces, 1);

  TriMesh flat = mesh;
  flat.faces.push_back({1, 1, 3});
  flat.vertices[3] = {2, 0, 0};
  flat.faces.push_back({0, 1, 3});  // collinear
  EXPECT_EQ(CheckMesh(flat).degenerate_faces, 2);
}

// Breaks if orientation against the plane of the cluster is lost.
TEST(MeshChecks, CountsFlippedFaces) {
  LabelledMesh cube = MakeCube(2);
  EXPECT_EQ(FindFlippedFaces(cube.mesh, cube.partition).count, 0);
  std::swap(cube.mesh.faces[3][0], cube.mesh.faces[3][1]);
  const FlippedFaces flipped = FindFlippedFaces(cube.mesh, cube.partition);
  EXPECT_EQ(flipped.count, 1);
  EXPECT_NEAR(flipped.area_share, 1.0 / cube.mesh.NumFaces(), 1e-12);
}

}  // namespace
}  // namespace facet
