// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The figures that partition and merging must reach on a real scan.
#include <gtest/gtest.h>

#include <string>

#include "mesh/clean.h"
#include "mesh/merge.h"
#include "mesh/mesh_io.h"
#include "mesh/partition.h"
#include "util/resources.h"

namespace facet {
namespace {

TEST(PartitionData, Redkitchen) {
  const std::string folder = FACET_DATA_DIR;
  if (folder.empty()) {
    GTEST_SKIP() << "FACET_DATA_DIR is not set: no redkitchen mesh";
  }
  TriMesh mesh = ReadMesh(folder + "/redkitchen/dense_10mm.ply").mesh;
  CleanMesh(CleanOptions(), &mesh);
  ResetPeakRss();
  const double before = PeakRssMb();
  PartitionReport report;
  const PlanarPartition partition =
      PartitionMesh(mesh, PartitionOptions(), &report);
  const double bytes_per_face =
      (PeakRssMb() - before) * 1048576.0 / static_cast<double>(mesh.NumFaces());
  EXPECT_EQ(partition.clusters.size(), 2000u);
  EXPECT_LE(report.rms_m, 0.0048);
  EXPECT_LT(report.swapped_energy, report.greedy_energy);
  EXPECT_LT(bytes_per_face, 400);
  MergeReport merged;
  const PlanarPartition planes =
      MergePlanes(mesh, partition, MergeOptions(), &merged);
  EXPECT_LE(merged.rms_m, 0.007);
  EXPECT_LT(planes.clusters.size(), partition.clusters.size());
  for (int id : planes.face_cluster) {
    ASSERT_GE(id, 0);
    ASSERT_LT(id, static_cast<int>(planes.clusters.size()));
  }
}

}  // namespace
}  // namespace facet
