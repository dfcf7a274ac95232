// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "mesh/adjacency.h"

#include <gtest/gtest.h>

#include "tests/mesh/plane_scenes.h"

namespace facet {
namespace {

// Breaks if sides of a face are lost or counted twice.
TEST(Adjacency, ClosedCubeHasThreeHalvesEdgesAFace) {
  const LabelledMesh cube = MakeCube(4);
  const std::vector<MeshEdge> edges = CollectEdges(cube.mesh);
  EXPECT_EQ(2 * edges.size(), 3 * cube.mesh.NumFaces());
  int borders = 0;
  for (const MeshEdge& edge : edges) {
    EXPECT_LT(edge.v0, edge.v1);
    EXPECT_EQ(edge.num_faces, 2);
    borders += IsBorder(edge, cube.partition.face_cluster);
  }
  EXPECT_EQ(borders, 12 * 4);  // the edges of the cube, cut in four
}

// Breaks if rings are unsorted, one-sided or incomplete.
TEST(Adjacency, RingsAreSortedAndMutual) {
  const LabelledMesh sheet = MakeSheet(3, [](double, double) { return 0.0; });
  const std::vector<MeshEdge> edges = CollectEdges(sheet.mesh);
  const VertexRings rings = MakeVertexRings(edges, sheet.mesh.NumVertices());
  EXPECT_EQ(rings.neighbor.size(), 2 * edges.size());
  for (int v = 0; v < static_cast<int>(sheet.mesh.NumVertices()); ++v) {
    for (int k = rings.begin[v]; k < rings.begin[v + 1]; ++k) {
      if (k > rings.begin[v]) {
        EXPECT_LT(rings.neighbor[k - 1], rings.neighbor[k]);
      }
      const int w = rings.neighbor[k];
      EXPECT_TRUE(
          std::binary_search(rings.neighbor.begin() + rings.begin[w],
                             rings.neighbor.begin() + rings.begin[w + 1],
                             v));
    }
  }
}

// Breaks if a side from a vertex to itself becomes an edge, or if the third
// face at an edge is forgotten.
TEST(Adjacency, SoupIsCountedAsItIs) {
  TriMesh mesh;
  mesh.vertices.assign(5, Eigen::Vector3d::Zero());
  mesh.faces = {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}, {2, 2, 3}};
  int three = 0;
  for (const MeshEdge& edge : CollectEdges(mesh)) {
    EXPECT_NE(edge.v0, edge.v1);
    three += edge.num_faces == 3;
  }
  EXPECT_EQ(three, 1);
}

}  // namespace
}  // namespace facet
