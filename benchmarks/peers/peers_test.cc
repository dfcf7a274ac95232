// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The measures of the comparison know good from bad, and every program does
// what it is asked for on a cube.
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "benchmarks/peers/peer_quality.h"
#include "mesh/mesh_io.h"
#include "tests/mesh/plane_scenes.h"
#include "tests/support/temp_dir.h"

namespace facet {
namespace {

MeshDistanceOptions FewPoints() {
  MeshDistanceOptions options;
  options.num_points = 20000;
  return options;
}

TEST(PeerQuality, AMeshIsNoDistanceFromItself) {
  const TriMesh cube = MakeCube(4).mesh;
  const SimplificationQuality quality =
      MeasureSimplification(cube, MakeCube(9).mesh, FewPoints());
  EXPECT_LT(quality.distance.accuracy.max, 1e-6);
  EXPECT_LT(quality.distance.completeness.max, 1e-6);
  EXPECT_EQ(quality.checks.non_manifold_edges, 0);
  EXPECT_EQ(quality.flipped_share, 0);
}

// One of the six sides inside out.
TEST(PeerQuality, FlippedShareIsOfTheArea) {
  LabelledMesh cube = MakeCube(4);
  for (size_t f = 0; f < cube.mesh.NumFaces(); ++f) {
    auto& face = cube.mesh.faces[f];
    if (cube.partition.face_cluster[f] == 0) std::swap(face[0], face[1]);
  }
  const SimplificationQuality quality =
      MeasureSimplification(cube.mesh, MakeCube(4).mesh, FewPoints());
  EXPECT_NEAR(quality.flipped_share, 1.0 / 6, 0.01);
}

TEST(PeerQuality, PlanesOfACubeAreExact) {
  const LabelledMesh cube = MakeCube(4);
  const PartitionQuality quality =
      MeasurePartition(cube.mesh, cube.partition.face_cluster);
  EXPECT_EQ(quality.clusters, 6U);
  EXPECT_EQ(quality.unlabelled_share, 0);
  EXPECT_LT(quality.rms_m, 1e-9);
}

// Two opposite sides as one cluster: half a metre from the plane between them.
// A third of the area has no label, and labels need not be consecutive.
TEST(PeerQuality, UnlabelledFacesCountByAreaOnly) {
  const LabelledMesh cube = MakeCube(4);
  std::vector<int> label = cube.partition.face_cluster;
  for (int& id : label) id = id < 2 ? 7 : id < 4 ? -1 : id;
  const PartitionQuality quality = MeasurePartition(cube.mesh, label);
  EXPECT_EQ(quality.clusters, 3U);
  EXPECT_NEAR(quality.unlabelled_share, 1.0 / 3, 1e-9);
  EXPECT_GT(quality.rms_m, 0.1);
  EXPECT_LT(quality.rms_m, 0.5);
}

class PeerPrograms : public testing::Test {
 protected:
  void SetUp() override { WritePly(dir_ / "cube.ply", MakeCube(12).mesh); }

  // Runs a program on the cube; returns what it wrote.
  MeshFile Run(const std::string& program,
               const std::string& method,
               int count) {
    const std::string command =
        std::string(FACET_BIN_DIR) + "/bench-" + program + " " + method + " " +
        (dir_ / "cube.ply") + " " + std::to_string(count) + " " +
        (dir_ / "out.ply") + " >/dev/null";
    EXPECT_EQ(std::system(command.c_str()), 0) << command;
    return ReadMesh(dir_ / "out.ply");
  }

 private:
  TempDir dir_;
};

TEST_F(PeerPrograms, SimplifyKeepsTheCube) {
  const TriMesh cube = MakeCube(12).mesh;
  for (const char* program :
       {"facet-mesh", "peer-meshoptimizer", "peer-open3d", "peer-openmesh"}) {
    const TriMesh light = Run(program, "simplify", 100).mesh;
    EXPECT_LE(light.NumFaces(), 100U) << program;
    const SimplificationQuality quality =
        MeasureSimplification(light, cube, FewPoints());
    EXPECT_LT(quality.distance.accuracy.rms, 0.01) << program;
    EXPECT_LT(quality.distance.completeness.rms, 0.01) << program;
  }
}

TEST_F(PeerPrograms, PartitionsFindTheSidesOfTheCube) {
  for (const auto& [program, method, count] :
       {std::tuple{"facet-mesh", "partition", 6},
        std::tuple{"facet-mesh", "merge", 6},
        std::tuple{"peer-cgal", "region-growing", 50}}) {
    const MeshFile file = Run(program, method, count);
    const PartitionQuality quality =
        MeasurePartition(file.mesh, file.face_plane);
    EXPECT_EQ(quality.clusters, 6U) << method;
    EXPECT_EQ(quality.unlabelled_share, 0) << method;
    EXPECT_LT(quality.rms_m, 1e-6) << method;
  }
  // Seeds of a variational approximation need not find all six.
  const MeshFile file = Run("peer-cgal", "vsa", 12);
  const PartitionQuality quality = MeasurePartition(file.mesh, file.face_plane);
  EXPECT_EQ(quality.clusters, 12U);
  EXPECT_LT(quality.rms_m, 0.05);
}

}  // namespace
}  // namespace facet
