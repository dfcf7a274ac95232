// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "mesh/simplify.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "mesh/adjacency.h"
#include "tests/mesh/plane_scenes.h"
#include "tests/mesh/simplify_checks.h"
#include "util/errors.h"
#include "util/parallel_for.h"

namespace facet {
namespace {

double Area(const TriMesh& mesh) {
  double area = 0;
  for (size_t f = 0; f < mesh.NumFaces(); ++f) area += mesh.FaceArea(f);
  return area;
}

// Breaks if sharp corners are worn down, planes bend, or flat faces are kept
// for nothing: a cube is twelve triangles, whatever the grid.
TEST(Simplify, CubeBecomesTwelveTriangles) {
  const LabelledMesh cube = MakeCube(8);
  SimplifyOptions options;
  options.target_faces = 1;
  const SimplifyResult result =
      SimplifyByPlanes(cube.mesh, cube.partition, options);
  ExpectSound(cube, result);
  EXPECT_EQ(result.mesh.NumFaces(), 12u);
  constexpr double kPull = 3e-5;  // by the quadrics that anchor vertices [m]
  EXPECT_NEAR(Area(result.mesh), 6, 24 * kPull);  // four corners a side
  for (size_t v = 0; v < result.mesh.NumVertices(); ++v) {
    EXPECT_LT(
        (result.mesh.vertices[v] - cube.mesh.vertices[result.vertex_birth[v]])
            .norm(),
        kPull);
  }
}

// Half a plane and half a wave.
LabelledMesh MakeWavySheet() {
  return MakeSheet(24, [](double x, double y) {
    return x <= 0.5 ? 0 : 0.02 * std::sin(25 * (x - 0.5)) * std::cos(12 * y);
  });
}

// Breaks if the budget is missed, or shape is spent where it is flat: half the
// sheet is a plane and half is a wave.
TEST(Simplify, BudgetGoesWhereTheShapeIs) {
  const LabelledMesh sheet = MakeWavySheet();
  SimplifyOptions options;
  options.target_faces = 400;
  options.free_error_m = 0;
  const SimplifyResult result =
      SimplifyByPlanes(sheet.mesh, sheet.partition, options);
  ExpectSound(sheet, result);
  EXPECT_LE(result.mesh.NumFaces(), 400u);
  EXPECT_GE(result.mesh.NumFaces(), 398u);
  EXPECT_GT(result.partition.clusters[1].num_faces,
            2 * result.partition.clusters[0].num_faces);
}

// Breaks if sweeps go where the shape is, pile collapses up on one vertex, or
// go on below what they should leave to the collapses by cost.
TEST(Simplify, SweepsCostNoShape) {
  const LabelledMesh sheet = MakeWavySheet();
  SimplifyOptions options;
  options.target_faces = 200;
  options.free_error_m = 0;
  options.sweep_ratio = 0;
  const SimplifyResult plain =
      SimplifyByPlanes(sheet.mesh, sheet.partition, options);
  options.sweep_ratio = 2;
  const SimplifyResult swept =
      SimplifyByPlanes(sheet.mesh, sheet.partition, options);
  ExpectSound(sheet, swept);
  EXPECT_LE(swept.mesh.NumFaces(), 200u);
  EXPECT_GE(swept.mesh.NumFaces(), 198u);
  EXPECT_NE(swept.vertex_birth, plain.vertex_birth);  // there were sweeps
  EXPECT_LE(swept.report.max_error_m, 1.1 * plain.report.max_error_m);
}

// Breaks if the budget by area goes on where a collapse costs too much.
TEST(Simplify, DearCollapsesAreNotMade) {
  const LabelledMesh sheet = MakeWavySheet();
  SimplifyOptions options;
  options.faces_per_m2 = 1;
  options.free_error_m = 0;
  double last_error = 1;
  size_t last_faces = 0;
  for (const double max_cost : {1e-6, 1e-8, 1e-10}) {
    options.max_cost_m4 = max_cost;
    const SimplifyResult result =
        SimplifyByPlanes(sheet.mesh, sheet.partition, options);
    ExpectSound(sheet, result);
    EXPECT_GT(result.mesh.NumFaces(), last_faces);
    EXPECT_LT(result.report.max_error_m, last_error);
    last_faces = result.mesh.NumFaces();
    last_error = result.report.max_error_m;
  }
}

// Volume between z = 0 and the faces of a cluster, which lie above it.
double VolumeBelow(const TriMesh& mesh, const std::vector<int>& label, int id) {
  double volume = 0;
  for (size_t f = 0; f < mesh.NumFaces(); ++f) {
    if (label[f] != id) continue;
    volume += 0.5 * mesh.FaceCross(f).z() * mesh.FaceCentroid(f).z();
  }
  return volume;
}

// Breaks if what stands off the plane of its cluster is flattened onto it, or
// what lies near the plane is not drawn to it any more: half a sheet has a
// table of 6 cm, the other one waves of 1 mm.
TEST(Simplify, PlanesDrawOnlyWhatIsNear) {
  LabelledMesh sheet = MakeSheet(24, [](double x, double y) {
    if (x <= 0.5) return 0.001 * std::sin(80 * x) * std::sin(70 * y);
    return x > 0.6 && x < 0.9 && y > 0.3 && y < 0.7 ? 0.06 : 0;
  });
  for (PlaneCluster& cluster : sheet.partition.clusters) {
    cluster.plane = Plane{Eigen::Vector3d::UnitZ(), 0};
  }
  SimplifyOptions options;
  options.target_faces = 60;
  options.free_error_m = 0;
  const double table = VolumeBelow(sheet.mesh, sheet.partition.face_cluster, 1);
  SimplifyResult result =
      SimplifyByPlanes(sheet.mesh, sheet.partition, options);
  ExpectSound(sheet, result);
  EXPECT_NEAR(VolumeBelow(result.mesh, result.partition.face_cluster, 1),
              table,
              0.03 * table);
  for (const Eigen::Vector3d& v : result.mesh.vertices) {
    EXPECT_TRUE(v.x() > 0.45 || std::abs(v.z()) < 0.0005) << v.transpose();
  }
  options.plane_reach_m = 0;  // the same share at any distance
  result = SimplifyByPlanes(sheet.mesh, sheet.partition, options);
  EXPECT_LT(VolumeBelow(result.mesh, result.partition.face_cluster, 1),
            0.8 * table);
}

// Breaks if step 1 touches borders: every border vertex of the input is still
// there, where it was, when step 2 has nothing to do.
TEST(Simplify, StepOneLeavesBorders) {
  const LabelledMesh cube = MakeCube(6);
  SimplifyOptions options;
  options.stop = SimplifyStop::kCounts;
  options.border_ratio = 1;
  const SimplifyResult result =
      SimplifyByPlanes(cube.mesh, cube.partition, options);
  ExpectSound(cube, result);
  EXPECT_EQ(result.report.border_edges_after, 12 * 6);
  EXPECT_LT(result.mesh.NumFaces(), cube.mesh.NumFaces() / 2);
  std::vector<int> birth = result.vertex_birth;
  std::sort(birth.begin(), birth.end());
  for (const MeshEdge& edge : CollectEdges(cube.mesh)) {
    if (!IsBorder(edge, cube.partition.face_cluster)) continue;
    EXPECT_TRUE(std::binary_search(birth.begin(), birth.end(), edge.v0));
    EXPECT_TRUE(std::binary_search(birth.begin(), birth.end(), edge.v1));
  }
}

// Breaks if the counts of the paper's two steps are not met.
TEST(Simplify, PaperCounts) {
  const LabelledMesh cube = MakeCube(20);
  SimplifyOptions options;
  options.stop = SimplifyStop::kCounts;
  options.collapse_to_border = false;
  const SimplifyResult result =
      SimplifyByPlanes(cube.mesh, cube.partition, options);
  ExpectSound(cube, result);
  EXPECT_LE(result.report.border_edges_after,
            std::max(10.0, 0.1 * result.report.border_edges_before));
}

// Breaks if a boundary vertex is moved or removed although it was to be kept.
TEST(Simplify, KeepsTheMeshBoundary) {
  const LabelledMesh sheet =
      MakeSheet(8, [](double x, double y) { return 0.01 * x * y; });
  SimplifyOptions options;
  options.target_faces = 1;
  options.keep_mesh_boundary = true;
  const SimplifyResult result =
      SimplifyByPlanes(sheet.mesh, sheet.partition, options);
  ExpectSound(sheet, result);
  EXPECT_EQ(result.report.checks_after.boundary_edges,
            result.report.checks_before.boundary_edges);
}

// Breaks if a closed surface of one label, without any border, is eaten up, or
// the test for tetrahedra is lost.
TEST(Simplify, ClosedSurfaceOfOneLabelStaysClosed) {
  LabelledMesh cube = MakeCube(3);
  cube.partition.face_cluster.assign(cube.mesh.NumFaces(), 0);
  RefitClusters(cube.mesh, &cube.partition);
  SimplifyOptions options;
  options.target_faces = 1;
  options.max_error_m = 10;
  const SimplifyResult result =
      SimplifyByPlanes(cube.mesh, cube.partition, options);
  EXPECT_GE(result.mesh.NumFaces(), 4u);
  EXPECT_EQ(result.report.checks_after.euler, 2);
  EXPECT_EQ(result.report.checks_after.duplicate_faces, 0);
  EXPECT_EQ(result.report.checks_after.boundary_edges, 0);
}

// Breaks if a collapse or a queue depends on the number of threads or on
// anything but the input.
TEST(Simplify, SameInputSameBits) {
  const LabelledMesh sheet = MakeSheet(
      12, [](double x, double y) { return 0.05 * std::sin(9 * x + 4 * y); });
  SimplifyOptions options;
  options.target_faces = 150;
  SetNumThreads(1);
  const auto one = SimplifyByPlanes(sheet.mesh, sheet.partition, options);
  SetNumThreads(2);
  const auto two = SimplifyByPlanes(sheet.mesh, sheet.partition, options);
  SetNumThreads(0);
  EXPECT_EQ(one.mesh.faces, two.mesh.faces);
  EXPECT_EQ(one.mesh.vertices, two.mesh.vertices);
}

// Breaks if bad options or a non-manifold mesh get through.
TEST(Simplify, RefusesWhatItCannotDo) {
  LabelledMesh sheet = MakeSheet(2, [](double, double) { return 0.0; });
  SimplifyOptions options;
  options.border_ratio = 0;
  EXPECT_THROW(SimplifyByPlanes(sheet.mesh, sheet.partition, options),
               OptionsError);
  sheet.mesh.faces.push_back(sheet.mesh.faces[0]);
  sheet.partition.face_cluster.push_back(0);
  EXPECT_THROW(SimplifyByPlanes(sheet.mesh, sheet.partition, SimplifyOptions()),
               UnsolvableError);
}

}  // namespace
}  // namespace facet
