// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "mesh/clean.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "mesh/edge_uses.h"
#include "tests/mesh/test_shapes.h"
#include "util/errors.h"
#include "util/warnings.h"

namespace facet {
namespace {

CleanOptions KeepAll() {
  CleanOptions options;
  options.min_component_faces = 0;
  return options;
}

size_t IrregularEdges(const TriMesh& mesh) {
  const std::vector<EdgeUse> uses = SortedEdgeUses(mesh);
  size_t count = 0;
  ForEachEdge(uses, [&](size_t begin, size_t end) {
    const size_t n = end - begin;
    count += n > 2 || (n == 2 && uses[begin].Forward(mesh) ==
                                     uses[begin + 1].Forward(mesh));
  });
  return count;
}

// Each kind of defect is counted once, under its own name, and the sound faces
// survive in their order.
TEST(CleanMesh, CountsEveryKind) {
  TriMesh mesh;
  AddGrid({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 4, 4, &mesh);
  const auto sound = mesh.faces;
  const int n = static_cast<int>(mesh.NumVertices());
  mesh.vertices.push_back({std::nan(""), 0, 0});  // n
  mesh.vertices.push_back(mesh.vertices[3]);      // n + 1, equal
  mesh.vertices.push_back({0.5, 0, 0});           // n + 2, equal to 2
  mesh.vertices.push_back({5, 5, 5});             // n + 3, unused
  mesh.vertices.push_back({0.125, 0, 0});         // n + 4, collinear
  mesh.faces.push_back({0, 1, n});                // not finite
  mesh.faces.push_back({0, 1, 1000});             // out of range
  mesh.faces.push_back({0, -1, 1});               // out of range
  mesh.faces.push_back({3, n + 1, 8});            // equal corners
  mesh.faces.push_back({0, n + 4, 1});            // no area
  mesh.faces.push_back({sound[5][1], sound[5][2], sound[5][0]});  // duplicate
  mesh.faces.push_back({sound[6][1], sound[6][0], sound[6][2]});  // reversed
  const size_t warnings = Warnings().size();
  const CleanReport report = CleanMesh(KeepAll(), &mesh);
  EXPECT_EQ(mesh.faces, sound);
  EXPECT_EQ(report.non_finite_vertices, 1u);
  EXPECT_EQ(report.non_finite_faces, 1u);
  EXPECT_EQ(report.bad_index_faces, 2u);
  EXPECT_EQ(report.welded_vertices, 2u);
  EXPECT_EQ(report.repeated_index_faces, 1u);
  EXPECT_EQ(report.zero_area_faces, 1u);
  EXPECT_EQ(report.duplicate_faces, 2u);
  EXPECT_EQ(report.unreferenced_vertices, 2u);
  EXPECT_EQ(report.RemovedFaces(), 7u);
  EXPECT_EQ(mesh.NumVertices(), static_cast<size_t>(n));
  EXPECT_EQ(Warnings().size(), warnings + 1);
}

// Cleaning a clean mesh must change nothing and say so.
TEST(CleanMesh, IsIdempotent) {
  TriMesh mesh = MakeBoxSoup(1, 4);
  CleanMesh(CleanOptions(), &mesh);
  const TriMesh before = mesh;
  const CleanReport report = CleanMesh(CleanOptions(), &mesh);
  EXPECT_EQ(mesh.faces, before.faces);
  EXPECT_EQ(mesh.vertices, before.vertices);
  EXPECT_EQ(report.Summary(), "nothing to clean");
  EXPECT_NEAR(report.diagonal_m, std::sqrt(3.0), 1e-12);
}

// A soup of six grids becomes a closed box: V = 6 n^2 + 2.
TEST(CleanMesh, WeldsASoup) {
  for (double jitter : {0.0, 1e-7}) {
    TriMesh mesh = MakeBoxSoup(1, 5);
    AddNoise(jitter, 3, &mesh);
    for (size_t v = 0; v < mesh.NumVertices(); ++v) {
      mesh.vertex_colors.push_back({uint8_t(v), 0, 0});
    }
    // Away from the borders of the welding grid's cells.
    for (auto& v : mesh.vertices) v += Eigen::Vector3d::Constant(3e-4);
    CleanOptions options;
    options.weld_tolerance_m = jitter > 0 ? 1e-3 : 0;
    CleanMesh(options, &mesh);
    EXPECT_EQ(mesh.NumVertices(), 152u);
    EXPECT_EQ(mesh.vertex_colors.size(), 152u);
    EXPECT_EQ(mesh.NumFaces(), 300u);
  }
}

// A speck goes, the larger piece stays.
TEST(CleanMesh, DropsSmallPieces) {
  TriMesh mesh;
  AddGrid({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 4, 4, &mesh);
  AddGrid({9, 0, 0}, {1, 0, 0}, {0, 1, 0}, 3, 3, &mesh);
  const CleanReport report = CleanMesh(CleanOptions(), &mesh);
  EXPECT_EQ(report.small_components, 1u);
  EXPECT_EQ(report.small_component_faces, 18u);
  EXPECT_EQ(mesh.NumFaces(), 32u);
  EXPECT_EQ(mesh.NumVertices(), 25u);
}

// A mesh of a few faces is no speck.
TEST(CleanMesh, SmallMeshStays) {
  TriMesh mesh;
  AddGrid({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 2, 2, &mesh);
  AddGrid({9, 0, 0}, {1, 0, 0}, {0, 1, 0}, 1, 1, &mesh);
  EXPECT_EQ(CleanMesh(CleanOptions(), &mesh).small_component_faces, 2u);
  EXPECT_EQ(mesh.NumFaces(), 8u);
}

TEST(CleanMesh, NothingLeftIsAnInputError) {
  TriMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  mesh.faces = {{0, 1, 2}, {0, 1, 7}};
  EXPECT_THROW(CleanMesh(KeepAll(), &mesh), InputError);
}

// Millimetres taken for metres.
TEST(CleanMesh, WarnsAboutUnits) {
  for (double size : {0.01, 4000.0}) {
    TriMesh mesh = MakeBoxSoup(size, 4);
    const size_t warnings = Warnings().size();
    CleanMesh(KeepAll(), &mesh);
    EXPECT_EQ(Warnings().size(), warnings + 1);
  }
  CleanOptions bad;
  bad.weld_tolerance_m = -1;
  TriMesh mesh = MakeBoxSoup(1, 4);
  EXPECT_THROW(CleanMesh(bad, &mesh), OptionsError);
}

// Two boxes that share an edge: four faces meet in it. They must come apart as
// two closed boxes, not as open sheets.
TEST(SplitNonManifold, BoxesAtAnEdgeStayClosed) {
  TriMesh mesh = MakeBoxSoup(1, 3);
  const TriMesh other = MakeBoxSoup(1, 3);
  const int first = static_cast<int>(mesh.NumVertices());
  for (const auto& v : other.vertices) {
    mesh.vertices.push_back(v + Eigen::Vector3d(1, 1, 0));
  }
  for (auto f : other.faces) {
    for (int& v : f) v += first;
    mesh.faces.push_back(f);
  }
  CleanMesh(CleanOptions(), &mesh);
  ASSERT_EQ(IrregularEdges(mesh), 3u);
  const SplitReport report = SplitNonManifold(&mesh);
  EXPECT_EQ(report.non_manifold_edges, 3u);
  EXPECT_EQ(report.split_vertices, 4u);
  EXPECT_EQ(report.added_vertices, 4u);
  EXPECT_EQ(IrregularEdges(mesh), 0u);
  EXPECT_EQ(mesh.NumVertices(), 2 * 56u);
  // Closed: every edge has two faces.
  EXPECT_EQ(FacePairs(mesh).size(), 3 * mesh.NumFaces() / 2);
}

// Corners of faces must not move, whatever soup comes.
TEST(SplitNonManifold, RandomSoupsBecomeManifold) {
  for (uint64_t seed = 0; seed < 30; ++seed) {
    Random random(seed);
    TriMesh mesh;
    for (int v = 0; v < 8; ++v) {
      mesh.vertices.push_back(
          {random.Uniform(), random.Uniform(), random.Uniform()});
    }
    for (int f = 0; f < 40; ++f) {
      mesh.faces.push_back(
          {int(random.Index(8)), int(random.Index(8)), int(random.Index(8))});
    }
    CleanMesh(KeepAll(), &mesh);
    const TriMesh before = mesh;
    SplitNonManifold(&mesh);
    EXPECT_EQ(IrregularEdges(mesh), 0u) << seed;
    ASSERT_EQ(mesh.NumFaces(), before.NumFaces());
    for (size_t f = 0; f < mesh.NumFaces(); ++f) {
      for (int k = 0; k < 3; ++k) {
        EXPECT_EQ(mesh.vertices[mesh.faces[f][k]],
                  before.vertices[before.faces[f][k]]);
      }
    }
    // Nothing is left to split.
    TriMesh again = mesh;
    EXPECT_EQ(SplitNonManifold(&again).added_vertices, 0u) << seed;
  }
}

// A vertex where two fans touch (a bow tie) is split; sound meshes are not.
TEST(SplitNonManifold, BowTieAndSoundMesh) {
  TriMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {-1, 0, 0}, {-1, -1, 0}};
  mesh.faces = {{0, 1, 2}, {0, 3, 4}};
  mesh.vertex_colors.assign(5, Rgb{1, 2, 3});
  EXPECT_EQ(SplitNonManifold(&mesh).added_vertices, 1u);
  EXPECT_EQ(mesh.vertex_colors.size(), 6u);
  TriMesh box = MakeBoxSoup(1, 4);
  CleanMesh(CleanOptions(), &box);
  const auto faces = box.faces;
  SplitNonManifold(&box);
  EXPECT_EQ(box.faces, faces);
}

}  // namespace
}  // namespace facet
