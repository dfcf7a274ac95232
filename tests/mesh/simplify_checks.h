// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#pragma once

#include <gtest/gtest.h>

#include "mesh/simplify.h"
#include "tests/mesh/plane_scenes.h"

namespace facet {

// The guarantees of method, Sec. 3.6.
inline void ExpectSound(const LabelledMesh& in, const SimplifyResult& out) {
  const MeshChecks& a = out.report.checks_before;
  const MeshChecks& b = out.report.checks_after;
  EXPECT_EQ(b.non_manifold_edges + b.non_manifold_vertices + b.duplicate_faces +
                b.degenerate_faces + b.isolated_vertices,
            0);
  EXPECT_EQ(a.components, b.components);
  EXPECT_EQ(a.boundary_loops, b.boundary_loops);
  EXPECT_EQ(a.euler, b.euler);
  EXPECT_LE(out.report.flipped_after.count, out.report.flipped_before.count);
  ASSERT_EQ(out.partition.clusters.size(), in.partition.clusters.size());
  for (const PlaneCluster& c : out.partition.clusters)
    EXPECT_GE(c.num_faces, 1);
  ASSERT_EQ(out.partition.face_cluster.size(), out.mesh.NumFaces());
  ASSERT_EQ(out.vertex_birth.size(), out.mesh.NumVertices());
}

}  // namespace facet
