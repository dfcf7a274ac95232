// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>

#include "mesh/clean.h"
#include "mesh/mesh_regions.h"
#include "mesh/partition.h"
#include "mesh/partition_steps.h"
#include "tests/mesh/test_shapes.h"
#include "util/parallel_for.h"

namespace facet {
namespace {

TriMesh NoisyBox() {
  TriMesh mesh = MakeBoxSoup(1, 40);  // 19,200 faces
  CleanMesh(CleanOptions(), &mesh);
  AddNoise(0.002, 1, &mesh);
  return mesh;
}

PartitionOptions InRegions(int region_faces) {
  PartitionOptions options;
  options.target_clusters = 100;
  options.region_faces = region_faces;
  return options;
}

// Breaks if regions are left as seams that the rest cannot mend, or take more
// merges than are harmless.
TEST(MergeInRegions, CostsNoFit) {
  const TriMesh mesh = NoisyBox();
  PartitionReport whole, regions;
  const PlanarPartition a = PartitionMesh(mesh, InRegions(0), &whole);
  const PlanarPartition b = PartitionMesh(mesh, InRegions(1000), &regions);
  EXPECT_EQ(a.clusters.size(), b.clusters.size());
  EXPECT_NE(a.face_cluster, b.face_cluster);  // there were regions
  EXPECT_LT(regions.rms_m, 1.02 * whole.rms_m);
  EXPECT_LT(regions.swapped_energy, 1.1 * whole.swapped_energy);
}

// Breaks if what a thread does depends on another one.
TEST(MergeInRegions, SameAtAnyThreadCount) {
  const TriMesh mesh = NoisyBox();
  SetNumThreads(1);
  const PlanarPartition one = PartitionMesh(mesh, InRegions(1000));
  SetNumThreads(4);
  const PlanarPartition four = PartitionMesh(mesh, InRegions(1000));
  SetNumThreads(0);
  EXPECT_EQ(one.face_cluster, four.face_cluster);
}

// Breaks if labels of regions get mixed up: every cluster is one piece, there
// are as many as asked for, and each has about as many faces.
TEST(MergeInRegions, ClustersAreConnectedAndOfTheSizeAskedFor) {
  const TriMesh mesh = NoisyBox();
  std::vector<int> label;
  const int count = MergeInRegions(mesh,
                                   FacePairs(mesh),
                                   ClusterEnergyOptions(),
                                   GreedyLimits(),
                                   2000,
                                   32,
                                   &label);
  EXPECT_EQ(count, 1 + *std::max_element(label.begin(), label.end()));
  EXPECT_NEAR(count, mesh.NumFaces() / 32.0, 0.1 * mesh.NumFaces() / 32.0);
  int loose = 0;
  SplitIntoPieces(mesh, BuildFaceNeighbors(mesh), count, false, &label, &loose);
  EXPECT_EQ(loose, 0);
}

// Breaks if limits of single unions do not hold inside regions.
TEST(MergeInRegions, MaxRmsHolds) {
  const TriMesh mesh = NoisyBox();
  PartitionOptions options = InRegions(1000);
  options.target_clusters = 1;
  options.max_rms_m = 0.004;
  options.swap_borders = false;
  for (const PlaneCluster& cluster : PartitionMesh(mesh, options).clusters) {
    EXPECT_LE(cluster.rms, 0.004 * (1 + 1e-9));
  }
}

}  // namespace
}  // namespace facet
