// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "mesh/merge.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "mesh/clean.h"
#include "mesh/partition.h"
#include "tests/mesh/test_shapes.h"
#include "util/errors.h"
#include "util/warnings.h"

namespace facet {
namespace {

constexpr double kDegree = M_PI / 180;

// Welds, and labels by the position of the face.
PlanarPartition Label(const std::function<int(const Eigen::Vector3d&)>& label,
                      TriMesh* mesh) {
  CleanMesh(CleanOptions(), mesh);
  PlanarPartition partition;
  for (size_t f = 0; f < mesh->NumFaces(); ++f) {
    partition.face_cluster.push_back(label(mesh->FaceCentroid(f)));
  }
  RefitClusters(*mesh, &partition);
  return partition;
}

size_t NumPlanes(const TriMesh& mesh,
                 const PlanarPartition& partition,
                 const MergeOptions& options = MergeOptions(),
                 MergeReport* report = nullptr) {
  return MergePlanes(mesh, partition, options, report).clusters.size();
}

MergeOptions WithoutGuards() {
  MergeOptions options;
  options.max_rms_m = 0;
  options.max_drift_factor = 0;
  options.max_member_rms_m = 0;
  options.absorb_islands = false;
  return options;
}

// Two half planes that meet at x = 0 in this angle.
TriMesh Wedge(double degrees) {
  TriMesh mesh;
  const double a = degrees * kDegree;
  AddGrid({-1, 0, 0}, {1, 0, 0}, {0, 1, 0}, 6, 6, &mesh);
  AddGrid({0, 0, 0}, {std::cos(a), 0, std::sin(a)}, {0, 1, 0}, 6, 6, &mesh);
  return mesh;
}

int SideOfX(const Eigen::Vector3d& c) { return c.x() > 0; }

// Rule 1 alone, on both sides of its bound; distance and sheet rules are wide
// open, so a wrong angle is the only thing that can break this.
TEST(MergePlanes, RuleOneIsTheAngle) {
  for (double degrees : {0.0, 4.0, 7.9, 8.1, 12.0}) {
    TriMesh mesh = Wedge(degrees);
    const PlanarPartition partition = Label(SideOfX, &mesh);
    MergeOptions options = WithoutGuards();
    options.max_distance_m = 10;
    MergeReport report;
    EXPECT_EQ(NumPlanes(mesh, partition, options, &report),
              degrees < 8 ? 1u : 2u)
        << degrees;
    EXPECT_EQ(report.failed_normals > 0, degrees > 8);
  }
}

// Rule 2 alone: a step; the riser belongs to the upper tread.
TEST(MergePlanes, RuleTwoIsTheDistance) {
  for (double height : {0.02, 0.045, 0.055, 0.08}) {
    TriMesh mesh;
    AddGrid({-1, 0, 0}, {1, 0, 0}, {0, 1, 0}, 20, 20, &mesh);
    AddGrid({0, 0, 0}, {0, 0, height}, {0, 1, 0}, 1, 20, &mesh);
    AddGrid({0, 0, height}, {1, 0, 0}, {0, 1, 0}, 20, 20, &mesh);
    const PlanarPartition partition = Label(
        [&](const Eigen::Vector3d& c) { return c.z() > 0.1 * height; }, &mesh);
    MergeReport report;
    EXPECT_EQ(NumPlanes(mesh, partition, WithoutGuards(), &report),
              height < 0.05 ? 1u : 2u)
        << height;
    EXPECT_EQ(report.failed_distance > 0, height > 0.05);
  }
}

// The fast distance (area) must be at least the exact one's mean: a limit of 0
// vertices can only merge less.
TEST(MergePlanes, FastDistanceIsConservative) {
  TriMesh mesh;
  AddGrid({-1, 0, 0}, {1, 0, 0}, {0, 1, 0}, 9, 9, &mesh);
  AddGrid({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 9, 9, &mesh);
  AddNoise(0.01, 3, &mesh);
  for (auto& v : mesh.vertices) {
    if (std::abs(v.x()) < 0.05) v.x() = 0, v.z() = 0;
  }
  PlanarPartition partition = Label(SideOfX, &mesh);
  std::vector<int> all;
  for (size_t v = 0; v < mesh.NumVertices(); ++v) all.push_back(int(v));
  MergeOptions exact = WithoutGuards(), fast = exact;
  fast.max_exact_distances = 0;
  for (double bound = 0.002; bound < 0.02; bound += 0.001) {
    exact.max_distance_m = fast.max_distance_m = bound;
    EXPECT_LE(NumPlanes(mesh, partition, exact),
              NumPlanes(mesh, partition, fast));
  }
}

// Rule 3 alone: a panel of 2 cm, folded round; its sheets overlap. Normals are
// compared up to sign, or rule 1 would do.
TEST(MergePlanes, RuleThreeKeepsSheetsApart) {
  TriMesh mesh;
  AddGrid({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 10, 10, &mesh);
  AddGrid({1, 0, 0}, {0, 0, 0.02}, {0, 1, 0}, 1, 10, &mesh);
  AddGrid({1, 0, 0.02}, {-1, 0, 0}, {0, 1, 0}, 10, 10, &mesh);
  const PlanarPartition partition =
      Label([](const Eigen::Vector3d& c) { return c.z() > 0.001; }, &mesh);
  MergeOptions options = WithoutGuards();
  options.oriented_normals = false;
  MergeReport report;
  EXPECT_EQ(NumPlanes(mesh, partition, options, &report), 2u);
  EXPECT_EQ(report.failed_sheet, 1);
  options.min_sheet_deg = 0;  // the rule off
  EXPECT_EQ(NumPlanes(mesh, partition, options), 1u);
  options.oriented_normals = true;  // its two sides look apart
  EXPECT_EQ(NumPlanes(mesh, partition, options, &report), 2u);
  EXPECT_EQ(report.failed_normals, 1);
}

TEST(MergePredicates, Definitions) {
  Plane up, tilted;
  tilted.normal = {std::sin(0.1), 0, std::cos(0.1)};
  EXPECT_TRUE(NormalsAgree(up, tilted, 0.101 / kDegree, true));
  EXPECT_FALSE(NormalsAgree(up, tilted, 0.099 / kDegree, true));
  tilted.normal = -tilted.normal;
  EXPECT_FALSE(NormalsAgree(up, tilted, 0.101 / kDegree, true));
  EXPECT_TRUE(NormalsAgree(up, tilted, 0.101 / kDegree, false));
  up.offset = -1;
  EXPECT_DOUBLE_EQ(MeanDistance({{0, 0, 0}, {5, 5, 4}, {9, 9, 9}}, {0, 1}, up),
                   2);
  PlaneCluster a, b;
  EXPECT_FALSE(LieSideBySide(a, b, 80)) << "equal centroids";
  b.centroid = {std::cos(0.17), 0, std::sin(0.17)};
  EXPECT_TRUE(LieSideBySide(a, b, 80));
  b.centroid = {std::cos(0.18), 0, std::sin(0.18)};
  EXPECT_FALSE(LieSideBySide(a, b, 80));
}

// Patches of one plane that do not touch stay two planes.
TEST(MergePlanes, OnlyNeighboursMerge) {
  TriMesh mesh;
  AddGrid({-1, 0, 0}, {1, 0, 0}, {0, 1, 0}, 6, 6, &mesh);
  AddGrid({0.5, 0, 0}, {1, 0, 0}, {0, 1, 0}, 6, 6, &mesh);
  EXPECT_EQ(NumPlanes(mesh, Label(SideOfX, &mesh)), 2u);
}

// A cylinder of strips 6 degrees apart: each pair passes the rules, the whole
// must not become a few planes.
TEST(MergePlanes, CylinderKeepsItsRoundness) {
  TriMesh mesh;
  const int strips = 60;
  const double radius = 0.2;
  const auto at = [&](int k) {
    const double a = 2 * M_PI * (k % strips) / strips;
    return Eigen::Vector3d(radius * std::cos(a), radius * std::sin(a), 0);
  };
  for (int k = 0; k < strips; ++k) {
    AddGrid(at(k), at(k + 1) - at(k), {0, 0, 1}, 1, 10, &mesh);
  }
  const PlanarPartition partition = Label(
      [&](const Eigen::Vector3d& c) {
        const double a = std::atan2(c.y(), c.x());
        return static_cast<int>((a < 0 ? a + 2 * M_PI : a) / (2 * M_PI) *
                                strips);
      },
      &mesh);
  ASSERT_EQ(partition.clusters.size(), 60u);
  const PlanarPartition merged = MergePlanes(mesh, partition, MergeOptions());
  EXPECT_LT(merged.clusters.size(), 60u);
  for (size_t f = 0; f < mesh.NumFaces(); ++f) {
    const Plane& plane = merged.clusters[merged.face_cluster[f]].plane;
    EXPECT_GT(plane.normal.dot(mesh.FaceCross(f).normalized()),
              std::cos(16.01 * kDegree));
  }
}

// A thin thing on a table: rules and rms of the union let it through, the
// guard on members keeps it.
TEST(MergePlanes, ThinThingsStay) {
  TriMesh mesh;
  const double step = 1.0 / 40;
  AddGrid({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 40, 40, &mesh);
  const auto on = [&](double x, double y) {
    return x > 0.699 && x < 0.901 && y > 0.399 && y < 0.601;
  };
  for (auto& v : mesh.vertices) {
    if (on(v.x(), v.y())) v.z() = 0.012;
  }
  const PlanarPartition partition = Label(
      [&](const Eigen::Vector3d& c) {
        return on(c.x() - 0.4 * step, c.y()) || on(c.x() + 0.4 * step, c.y());
      },
      &mesh);
  MergeOptions options;
  options.absorb_islands = false;
  EXPECT_EQ(NumPlanes(mesh, partition, options), 2u);
  options.max_member_rms_m = 0;
  EXPECT_EQ(NumPlanes(mesh, partition, options), 1u);
}

// Islands: a small low bump goes, a high one and a large one stay, and so does
// one whose border is the mesh boundary.
TEST(MergePlanes, IslandsAreAbsorbedIfSmallAndClose) {
  struct Case {
    double size, height, corner;
    size_t planes;
  };
  for (const Case& c : {Case{0.04, 0.003, 0.5, 1},
                        Case{0.04, 0.03, 0.5, 2},
                        Case{0.3, 0.003, 0.5, 2},
                        Case{0.04, 0.003, 0, 2}}) {
    TriMesh mesh;
    AddGrid({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 50, 50, &mesh);
    const auto on = [&](const Eigen::Vector3d& p) {
      return p.x() > c.corner - 1e-9 && p.x() < c.corner + c.size + 1e-9 &&
             p.y() > c.corner - 1e-9 && p.y() < c.corner + c.size + 1e-9;
    };
    for (auto& v : mesh.vertices) {
      if (on(v)) v.z() = c.height;
    }
    const PlanarPartition partition =
        Label([&](const Eigen::Vector3d& p) { return on(p); }, &mesh);
    MergeOptions options;
    options.merge_planes = false;
    EXPECT_EQ(NumPlanes(mesh, partition, options), c.planes)
        << c.size << " " << c.height << " " << c.corner;
    options.absorb_islands = false;
    EXPECT_EQ(NumPlanes(mesh, partition, options), 2u);
  }
}

// Ids by area, statistics refitted, nothing lost, input labels irrelevant.
TEST(MergePlanes, OutputIsOrderedAndComplete) {
  TriMesh mesh = MakeBoxSoup(1, 12);
  CleanMesh(CleanOptions(), &mesh);
  AddNoise(0.001, 5, &mesh);
  PartitionOptions options;
  options.target_clusters = 40;
  PlanarPartition partition = PartitionMesh(mesh, options);
  MergeReport report;
  const PlanarPartition merged =
      MergePlanes(mesh, partition, MergeOptions(), &report);
  EXPECT_LT(merged.clusters.size(), 40u);
  EXPECT_EQ(merged.clusters.size(),
            40u - static_cast<size_t>(report.merges + report.islands));
  double area = 0;
  for (size_t i = 0; i < merged.clusters.size(); ++i) {
    area += merged.clusters[i].area;
    if (i == 0) continue;
    EXPECT_GE(merged.clusters[i - 1].area, merged.clusters[i].area);
  }
  double mesh_area = 0;
  for (size_t f = 0; f < mesh.NumFaces(); ++f) mesh_area += mesh.FaceArea(f);
  EXPECT_NEAR(area, mesh_area, 1e-9);
  EXPECT_NEAR(report.rms_m, PartitionRms(mesh, merged), 1e-15);
  // A cluster lies in one plane only.
  std::vector<int> plane(40, -1);
  for (size_t f = 0; f < mesh.NumFaces(); ++f) {
    int& p = plane[partition.face_cluster[f]];
    if (p < 0) p = merged.face_cluster[f];
    EXPECT_EQ(p, merged.face_cluster[f]);
  }
}

// Faces turned at random: normals are compared up to sign, with a warning.
TEST(MergePlanes, UnorientedMeshFallsBack) {
  TriMesh mesh = Wedge(0);
  const PlanarPartition partition = Label(SideOfX, &mesh);
  for (size_t f = 0; f < mesh.NumFaces(); ++f) {
    if (partition.face_cluster[f] == 0 || f % 3 == 0) {
      std::swap(mesh.faces[f][0], mesh.faces[f][1]);
    }
  }
  const size_t warnings = Warnings().size();
  MergeReport report;
  EXPECT_EQ(NumPlanes(mesh, partition, MergeOptions(), &report), 1u);
  EXPECT_FALSE(report.oriented);
  EXPECT_EQ(Warnings().size(), warnings + 1);
}

TEST(MergePlanes, SenselessOptionsAreRefused) {
  TriMesh mesh = Wedge(0);
  const PlanarPartition partition = Label(SideOfX, &mesh);
  MergeOptions options;
  options.max_normal_deg = 0;
  EXPECT_THROW(MergePlanes(mesh, partition, options), OptionsError);
  options = MergeOptions();
  options.max_distance_m = std::nan("");
  EXPECT_THROW(MergePlanes(mesh, partition, options), OptionsError);
  options = MergeOptions();
  options.max_member_rms_m = -1;
  EXPECT_THROW(MergePlanes(mesh, partition, options), OptionsError);
}

}  // namespace
}  // namespace facet
