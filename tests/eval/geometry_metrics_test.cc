// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "eval/mesh_distance.h"
#include "eval/plane_metrics.h"
#include "tests/support/temp_dir.h"
#include "util/atomic_file.h"
#include "util/errors.h"
#include "util/parallel_for.h"

namespace facet {
namespace {

void AddSquare(const Eigen::Vector3d& corner,
               const Eigen::Vector3d& a,
               const Eigen::Vector3d& b,
               TriMesh* mesh) {
  const int v = static_cast<int>(mesh->NumVertices());
  mesh->vertices.insert(mesh->vertices.end(),
                        {corner, corner + a, corner + a + b, corner + b});
  mesh->faces.push_back({v, v + 1, v + 2});
  mesh->faces.push_back({v, v + 2, v + 3});
}

TriMesh Square(double size, double z) {
  TriMesh mesh;
  AddSquare({0, 0, z}, {size, 0, 0}, {0, size, 0}, &mesh);
  return mesh;
}

// Squares on top of each other: every distance is the gap. Point-to-vertex
// distances or sampling outside of the triangles would not be.
TEST(MeshDistance, OfShiftedSquaresIsTheShift) {
  const MeshDistance d =
      CompareMeshes(Square(1, 0), Square(1, 0.015), {2000, 0});
  for (const DistanceStats& s : {d.accuracy, d.completeness}) {
    for (const double v : {s.mean, s.median, s.rms, s.p90, s.max}) {
      EXPECT_NEAR(v, 0.015, 1e-6);
    }
  }
  EXPECT_EQ(d.f_score[0], 0);  // 1 cm
  EXPECT_EQ(d.f_score[1], 1);  // 2 cm
}

// A model that is half of the reference is accurate but not complete: mixing up
// the two directions shows.
TEST(MeshDistance, TellsAccuracyFromCompleteness) {
  TriMesh half = Square(1, 0);
  for (Eigen::Vector3d& v : half.vertices) v.x() *= 0.5;
  const MeshDistance d = CompareMeshes(half, Square(1, 0), {20000, 0});
  EXPECT_NEAR(d.accuracy.max, 0, 1e-6);
  EXPECT_NEAR(d.completeness.mean, 0.125, 0.003);  // E max(0, x - 0.5)
  EXPECT_NEAR(d.completeness.max, 0.5, 0.01);
  EXPECT_EQ(d.precision[2], 1);
  EXPECT_NEAR(d.recall[2], 0.55, 0.01);
}

// Points go by area, not by face; the same seed gives the same points.
TEST(SampleSurface, IsUniformOverTheArea) {
  TriMesh mesh = Square(1, 0);
  AddSquare({5, 0, 0}, {3, 0, 0}, {0, 1, 0}, &mesh);
  mesh.faces.push_back({0, 0, 1});  // no area, never drawn
  const auto samples = SampleSurface(mesh, 20000, 5);
  size_t on_large = 0;
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const SurfaceSample& s : samples) {
    ASSERT_LT(s.face, 4);
    if (s.face < 2) continue;
    ++on_large;
    mean += s.point;
  }
  EXPECT_NEAR(on_large / 20000.0, 0.75, 0.015);
  EXPECT_LT((mean / on_large - Eigen::Vector3d(6.5, 0.5, 0)).norm(), 0.05);
  EXPECT_EQ(SampleSurface(mesh, 10, 5)[9].point,
            SampleSurface(mesh, 10, 5)[9].point);
  EXPECT_THROW(SampleSurface(TriMesh(), 10, 0), UnsolvableError);
}

TEST(MeshDistance, DoesNotDependOnThreads) {
  SetNumThreads(1);
  const MeshDistance one = CompareMeshes(Square(1, 0), Square(2, 1), {5000, 1});
  SetNumThreads(2);
  const MeshDistance two = CompareMeshes(Square(1, 0), Square(2, 1), {5000, 1});
  SetNumThreads(0);
  EXPECT_EQ(one.accuracy.mean, two.accuracy.mean);
  EXPECT_EQ(one.completeness.rms, two.completeness.rms);
}

class PlaneMetricsTest : public ::testing::Test {
 protected:
  // Floor (plane 4, 4 m^2), wall (plane 9, 1 m^2), and an unlabelled patch.
  PlaneMetricsTest() {
    AddSquare({0, 0, 0}, {2, 0, 0}, {0, 2, 0}, &mesh_);
    AddSquare({0, 5, 1}, {1, 0, 0}, {0, 0, 1}, &mesh_);
    AddSquare({9, 9, 0}, {1, 0, 0}, {0, 1, 0}, &mesh_);
    true_labels_ = {4, 4, 9, 9, -1, -1};
    labels_ = {0, 0, 1, 1, 2, 2};
    truth_ = {{4, {Eigen::Vector3d::UnitZ(), 0}},
              {9, {Eigen::Vector3d::UnitY(), -5}}};
  }
  PlaneMetrics Compare(const std::vector<NumberedPlane>& planes) const {
    PlaneMetricsOptions options;
    options.num_points = 5000;
    return ComparePlanes(
        planes, {&mesh_, &labels_}, truth_, {&mesh_, &true_labels_}, options);
  }
  TriMesh mesh_;
  std::vector<int> labels_, true_labels_;
  std::vector<NumberedPlane> truth_;
};

// A known tilt about the patch's centre and a known shift come out as they are;
// flipped normals are the same plane; other ids do not matter.
TEST_F(PlaneMetricsTest, MeasuresTiltAndShift) {
  const double tilt = 0.01;
  const Eigen::Vector3d n(std::sin(tilt), 0, std::cos(tilt));
  const Eigen::Vector3d center(1, 1, 0);
  const PlaneMetrics m = Compare({{0, {n, -n.dot(center)}},
                                  {1, {-Eigen::Vector3d::UnitY(), 5.003}},
                                  {2, {Eigen::Vector3d::UnitZ(), 0}}});
  ASSERT_EQ(m.planes.size(), 2u);
  EXPECT_EQ(m.unmatched, 1u);
  EXPECT_NEAR(m.matched_share, 5.0 / 6, 1e-9);
  EXPECT_EQ(m.planes[0].true_id, 4);
  EXPECT_NEAR(m.planes[0].angle_deg, tilt * 57.29577951, 1e-6);
  EXPECT_NEAR(m.planes[0].offset_m, 0, 1e-9);
  EXPECT_EQ(m.planes[1].true_id, 9);
  EXPECT_NEAR(m.planes[1].angle_deg, 0, 1e-6);
  EXPECT_NEAR(m.planes[1].offset_m, 0.003, 1e-9);
  EXPECT_NEAR(m.mean_angle_deg, 0.8 * tilt * 57.29577951, 1e-6);
  EXPECT_NEAR(m.mean_offset_m, 0.2 * 0.003, 1e-9);
  EXPECT_NEAR(m.median_offset_m, 0, 1e-9);
}

TEST_F(PlaneMetricsTest, RefusesMissingLabels) {
  labels_.clear();
  EXPECT_THROW(Compare(truth_), InputError);
}

TEST(ReadPlanes, ReadsBothLayoutsAndRefusesOthers) {
  const TempDir dir;
  const std::string path = dir / "planes.json";
  WriteFileAtomically(path, R"([{"id": 3, "normal": [0, 0, 2], "offset": 4}])");
  const auto planes = ReadPlanes(path);
  ASSERT_EQ(planes.size(), 1u);
  EXPECT_EQ(planes[0].id, 3);
  EXPECT_EQ(planes[0].plane.offset, 2);  // normalised
  EXPECT_TRUE(ReadPlanes(path, true).empty());
  WriteFileAtomically(path,
                      R"({"planes": [{"id": 3, "normal": [0, 0, 1], "offset": 4,
          "initial": {"normal": [0, 1, 0], "offset": 7}}]})");
  EXPECT_EQ(ReadPlanes(path, true)[0].plane.offset, 7);
  for (const char* text :
       {"",
        "{}",
        "[]",
        R"([{"id": 1}])",
        R"([{"id": 1, "normal": [0, 0], "offset": 1}])",
        R"([{"id": 1, "normal": [0, 0, 0], "offset": 1}])"}) {
    WriteFileAtomically(path, text);
    EXPECT_THROW(ReadPlanes(path), InputError) << text;
  }
  EXPECT_THROW(ReadPlanes(dir / "none.json"), InputError);
}

}  // namespace
}  // namespace facet
