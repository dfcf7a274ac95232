// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "mesh/partition.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "mesh/clean.h"
#include "mesh/edge_uses.h"
#include "mesh/greedy_merge.h"
#include "mesh/indexed_heap.h"
#include "mesh/partition_steps.h"
#include "tests/mesh/test_shapes.h"
#include "util/errors.h"
#include "util/parallel_for.h"
#include "util/warnings.h"

namespace facet {
namespace {

constexpr int kGrid = 20;

TriMesh NoisyBox(double sigma = 0.002) {
  TriMesh mesh = MakeBoxSoup(1, kGrid);
  CleanMesh(CleanOptions(), &mesh);
  AddNoise(sigma, 1, &mesh);
  return mesh;
}

PartitionOptions Target(int clusters) {
  PartitionOptions options;
  options.target_clusters = clusters;
  return options;
}

// Pieces that every cluster consists of, summed up.
int NumPieces(const TriMesh& mesh, const std::vector<int>& label) {
  std::vector<int> copy = label;
  int count = 1 + *std::max_element(label.begin(), label.end()), loose = 0;
  const int clusters = count;
  SplitIntoPieces(mesh, BuildFaceNeighbors(mesh), count, false, &copy, &loose);
  return clusters + loose;
}

// A wrong energy, cost or heap order mixes the sides.
TEST(Partition, NoisyBoxGivesItsSides) {
  const TriMesh mesh = NoisyBox();
  const PlanarPartition partition = PartitionMesh(mesh, Target(6));
  ASSERT_EQ(partition.clusters.size(), 6u);
  std::map<std::pair<int, int>, int> votes;  // (side, cluster)
  for (size_t f = 0; f < mesh.NumFaces(); ++f) {
    const int side = static_cast<int>(f) / (2 * kGrid * kGrid);
    ++votes[{side, partition.face_cluster[f]}];
  }
  int right = 0;
  std::vector<int> owner(6, -1);
  for (int side = 0; side < 6; ++side) {
    int best = 0;
    for (int c = 0; c < 6; ++c) {
      if (votes[{side, c}] <= best) continue;
      best = votes[{side, c}];
      owner[side] = c;
    }
    right += best;
  }
  EXPECT_GE(right, 0.98 * static_cast<double>(mesh.NumFaces()));
  // Normals face outward: away from the centre of the box.
  for (const PlaneCluster& c : partition.clusters) {
    const Eigen::Vector3d out = c.centroid - Eigen::Vector3d::Constant(0.5);
    EXPECT_GT(c.plane.normal.dot(out.normalized()), 0.999);
    EXPECT_NEAR(c.area, 1.0, 0.15);
  }
}

// Every face has a cluster, no id is unused, the count is the target, every
// cluster hangs together, the statistics add up.
TEST(Partition, IsAPartition) {
  const TriMesh mesh = NoisyBox();
  PartitionReport report;
  const PlanarPartition partition = PartitionMesh(mesh, Target(60), &report);
  ASSERT_EQ(partition.face_cluster.size(), mesh.NumFaces());
  ASSERT_EQ(partition.clusters.size(), 60u);
  int faces = 0;
  double area = 0, mesh_area = 0;
  for (const PlaneCluster& c : partition.clusters) {
    EXPECT_GT(c.num_faces, 0);
    EXPECT_NEAR(c.plane.SignedDistance(c.centroid), 0, 1e-12);
    faces += c.num_faces;
    area += c.area;
  }
  for (size_t f = 0; f < mesh.NumFaces(); ++f) mesh_area += mesh.FaceArea(f);
  EXPECT_EQ(faces, static_cast<int>(mesh.NumFaces()));
  EXPECT_NEAR(area, mesh_area, 1e-9);
  EXPECT_EQ(NumPieces(mesh, partition.face_cluster), 60);
  EXPECT_EQ(report.components, 1);
  EXPECT_NEAR(report.rms_m, PartitionRms(mesh, partition), 1e-15);
}

// A move that does not lower the sum, or sums that drift from the labels.
TEST(Partition, SwappingLowersTheEnergy) {
  const TriMesh mesh = NoisyBox(0.004);
  for (ClusterEnergyKind kind : {ClusterEnergyKind::kAuthors,
                                 ClusterEnergyKind::kContinuous,
                                 ClusterEnergyKind::kLambdaMin}) {
    PartitionOptions options = Target(40);
    options.energy.kind = kind;
    PartitionReport report;
    PartitionMesh(mesh, options, &report);
    EXPECT_GT(report.swapped_faces, 0u);
    EXPECT_LT(report.swapped_energy, report.greedy_energy);
  }
}

// Nothing depends on where the mesh stands, nor on the number of threads.
TEST(Partition, IsInvariant) {
  const TriMesh mesh = NoisyBox();
  const PlanarPartition partition = PartitionMesh(mesh, Target(30));
  TriMesh moved = mesh;
  const Eigen::AngleAxisd turn(1.1, Eigen::Vector3d(1, 2, -1).normalized());
  for (auto& v : moved.vertices) v = turn * v + Eigen::Vector3d(3, -4, 2);
  const PlanarPartition other = PartitionMesh(moved, Target(30));
  size_t same = 0;
  for (size_t f = 0; f < mesh.NumFaces(); ++f) {
    same += partition.face_cluster[f] == other.face_cluster[f];
  }
  EXPECT_GE(same, mesh.NumFaces() * 99 / 100);
  const int threads = NumThreads();
  SetNumThreads(1);
  const PlanarPartition single = PartitionMesh(mesh, Target(30));
  SetNumThreads(threads);
  EXPECT_EQ(single.face_cluster, partition.face_cluster);
}

// Without noise every union on a side is flat: determinants are rounding, all
// costs are nearly equal, and planes must come out exact all the same.
TEST(Partition, ExactlyFlatInput) {
  TriMesh mesh = MakeBoxSoup(1, 8);
  CleanMesh(CleanOptions(), &mesh);
  const PlanarPartition partition = PartitionMesh(mesh, Target(6));
  ASSERT_EQ(partition.clusters.size(), 6u);
  for (const PlaneCluster& c : partition.clusters) {
    EXPECT_NEAR(c.area, 1, 1e-12);
    EXPECT_NEAR(c.plane.normal.cwiseAbs().maxCoeff(), 1, 1e-12);
  }
  EXPECT_NEAR(PartitionRms(mesh, partition), 0, 1e-9);
}

// The bound on the rms holds for every union.
TEST(Partition, MaxRmsHolds) {
  const TriMesh mesh = NoisyBox();
  PartitionOptions options = Target(1);
  options.max_rms_m = 0.003;
  const PlanarPartition partition = PartitionMesh(mesh, options);
  EXPECT_GT(partition.clusters.size(), 5u);
  EXPECT_LT(partition.clusters.size(), 60u);
  for (const PlaneCluster& c : partition.clusters) EXPECT_LE(c.rms, 0.00305);
}

// A bent sheet among specks. Breaks if specks, which cannot be merged with
// anything, use up the clusters that the sheet needs: it would be one plane.
TEST(Partition, SpecksLeaveClustersToTheRest) {
  TriMesh mesh;
  AddGrid({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 4, 4, &mesh);
  AddGrid({1, 0, 0}, {0, 0, 1}, {0, 1, 0}, 4, 4, &mesh);
  CleanMesh({}, &mesh);  // joins them along the bend
  const size_t sheet = mesh.NumFaces();
  for (int k = 0; k < 20; ++k) {
    AddGrid({2.0 + 2 * k, 0, 0}, {1, 0, 0}, {0, 1, 0}, 1, 1, &mesh);
  }
  const size_t warnings = Warnings().size();
  PartitionReport report;
  const PlanarPartition partition = PartitionMesh(mesh, Target(6), &report);
  EXPECT_EQ(Warnings().size(), warnings + 1);
  EXPECT_EQ(report.components, 21);
  EXPECT_EQ(partition.clusters.size(), 24u);
  for (size_t f = 0; f < sheet; ++f) {
    EXPECT_LT(partition.clusters[partition.face_cluster[f]].rms, 1e-9);
  }
}

// Enough clusters for all pieces: the target is met. None asked for: refused.
TEST(Partition, TargetIsMetWithFewPieces) {
  TriMesh mesh;
  for (int k = 0; k < 3; ++k) {
    AddGrid({2.0 * k, 0, 0}, {1, 0, 0}, {0, 1, 0}, 4, 4, &mesh);
  }
  EXPECT_EQ(PartitionMesh(mesh, Target(6)).clusters.size(), 6u);
  EXPECT_THROW(PartitionMesh(mesh, Target(0)), OptionsError);
}

// Breaks if a small mesh is refused, or falls into empty clusters.
TEST(Partition, FewerFacesThanClusters) {
  TriMesh mesh;
  AddGrid({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 2, 2, &mesh);
  for (const int target : {8, 9, 2000}) {
    const size_t warnings = Warnings().size();
    const PlanarPartition partition = PartitionMesh(mesh, Target(target));
    ASSERT_EQ(partition.clusters.size(), mesh.NumFaces());
    for (size_t f = 0; f < mesh.NumFaces(); ++f) {
      EXPECT_EQ(partition.face_cluster[f], static_cast<int>(f));
      EXPECT_EQ(partition.clusters[f].num_faces, 1);
    }
    EXPECT_EQ(Warnings().size() - warnings, target > 8 ? 1u : 0u);
  }
}

// Three sheets in one edge: all faces there are neighbours, nothing breaks.
TEST(Partition, NonManifoldEdgeIsAllowed) {
  TriMesh mesh;
  AddGrid({0, 0, 0}, {0, 1, 0}, {-1, 0, 0.1}, 4, 4, &mesh);
  AddGrid({0, 0, 0}, {0, 1, 0}, {1, 0, 0}, 4, 4, &mesh);
  AddGrid({0, 0, 0}, {0, 1, 0}, {0, 0, 1}, 4, 4, &mesh);
  CleanMesh(CleanOptions(), &mesh);
  EXPECT_EQ(PartitionMesh(mesh, Target(3)).clusters.size(), 3u);
  EXPECT_EQ(PartitionMesh(mesh, Target(1)).clusters.size(), 1u);
}

// Two parallel sheets at distance 2 h as one cluster: rms is h exactly, and a
// plane moved by d gives sqrt(h^2 + d^2).
TEST(Partition, RmsIsExact) {
  TriMesh mesh;
  const double h = 0.01;
  AddGrid({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 3, 3, &mesh);
  AddGrid({0, 0, 2 * h}, {1, 0, 0}, {0, 1, 0}, 5, 2, &mesh);
  PlanarPartition partition;
  partition.face_cluster.assign(mesh.NumFaces(), 0);
  RefitClusters(mesh, &partition);
  ASSERT_EQ(partition.clusters.size(), 1u);
  EXPECT_NEAR(PartitionRms(mesh, partition), h, 1e-12);
  EXPECT_NEAR(partition.clusters[0].plane.normal.z(), 1, 1e-12);
  partition.clusters[0].plane.offset += 0.02;
  EXPECT_NEAR(PartitionRms(mesh, partition), std::hypot(h, 0.02), 1e-12);
}

// A loose piece with one neighbour joins it; one with two becomes a cluster.
TEST(Partition, LoosePieces) {
  TriMesh mesh;
  AddGrid({0, 0, 0}, {6, 0, 0}, {0, 1, 0}, 6, 1, &mesh);
  // Cells 0 ... 5 in a row, two faces each; cluster 0 is in three pieces.
  const std::vector<int> cells = {0, 1, 0, 2, 2, 0};
  std::vector<int> label;
  for (int c : cells) label.insert(label.end(), 2, c);
  label[0] = 1;      // the piece at the left is one face, in the middle two
  label.back() = 2;  // and at the right one
  int loose = 0;
  const int count =
      SplitIntoPieces(mesh, BuildFaceNeighbors(mesh), 3, true, &label, &loose);
  EXPECT_EQ(loose, 2);
  EXPECT_EQ(count, 3);
  EXPECT_EQ(label, (std::vector<int>{1, 1, 1, 1, 0, 0, 2, 2, 2, 2, 2, 2}));
}

// The heap must give what sorting gives, through changes and removals.
TEST(IndexedHeap, AgreesWithSorting) {
  Random random(7);
  const int n = 500;
  IndexedHeap heap(n);
  std::map<int, double> keys;
  for (int step = 0; step < 5000; ++step) {
    const int id = static_cast<int>(random.Index(n));
    if (random.Uniform() < 0.3) {
      heap.Remove(id);
      keys.erase(id);
    } else {
      keys[id] = static_cast<double>(random.Index(50));  // many ties
      heap.Set(id, keys[id]);
    }
  }
  std::vector<std::pair<double, int>> sorted;
  for (const auto& [id, key] : keys) sorted.emplace_back(key, id);
  std::sort(sorted.begin(), sorted.end());
  for (const auto& [key, id] : sorted) {
    ASSERT_EQ(heap.Top(), id);
    ASSERT_EQ(heap.TopKey(), key);
    heap.Remove(id);
  }
  EXPECT_TRUE(heap.Empty());
}

// The lean lists must take the same unions as a search over all pairs.
TEST(MergeGreedily, AgreesWithExhaustiveSearch) {
  TriMesh mesh;
  AddGrid({0, 0, 0}, {0.3, 0, 0}, {0, 0.3, 0}, 5, 5, &mesh);
  AddNoise(0.01, 9, &mesh);
  const ClusterEnergyOptions energy;
  const std::vector<std::pair<int, int>> pairs = FacePairs(mesh);
  std::vector<SurfaceMoments> items;
  for (size_t f = 0; f < mesh.NumFaces(); ++f) {
    items.push_back(FaceMoments(mesh, f));
  }
  std::vector<int> label(items.size());
  for (size_t f = 0; f < label.size(); ++f) label[f] = static_cast<int>(f);
  std::vector<SurfaceMoments> moments = items;
  for (size_t clusters = items.size(); clusters > 1; --clusters) {
    GreedyLimits limits;
    limits.target = clusters;
    const std::vector<int> greedy = MergeGreedily(limits, energy, items, pairs);
    for (size_t a = 0; a < label.size(); ++a) {
      for (size_t b = 0; b < a; ++b) {
        ASSERT_EQ(greedy[a] == greedy[b], label[a] == label[b]) << clusters;
      }
    }
    double best = 1e300;
    std::pair<int, int> choice;
    for (const auto& [f, g] : pairs) {
      const int a = label[f], b = label[g];
      if (a == b) continue;
      const double growth =
          ClusterEnergy(energy, Union(moments[a], moments[b])) -
          ClusterEnergy(energy, moments[a]) - ClusterEnergy(energy, moments[b]);
      if (growth >= best) continue;
      best = growth;
      choice = {a, b};
    }
    moments[choice.first] =
        Union(moments[choice.first], moments[choice.second]);
    for (int& l : label) {
      if (l == choice.second) l = choice.first;
    }
  }
}

}  // namespace
}  // namespace facet
