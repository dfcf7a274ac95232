// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "mesh/partition.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "mesh/greedy_merge.h"
#include "mesh/partition_steps.h"
#include "mesh/union_find.h"
#include "util/errors.h"
#include "util/warnings.h"

namespace facet {
namespace {

void CheckOptions(const PartitionOptions& options) {
  if (options.target_clusters < 1) {
    throw OptionsError("partition: target_clusters must be at least 1");
  }
  if (!(options.max_rms_m >= 0) || !(options.max_merge_energy >= 0) ||
      !(options.energy.alpha >= 0) || !(options.energy.tau >= 0) ||
      options.max_swap_sweeps < 0 || options.region_faces < 0) {
    throw OptionsError(
        "partition: max_rms_m, max_merge_energy, alpha, tau, max_swap_sweeps "
        "and region_faces must not be negative");
  }
}

int NumLabels(const std::vector<int>& label) {
  int count = 0;
  for (int l : label) count = std::max(count, l + 1);
  return count;
}

GreedyLimits Limits(const PartitionOptions& options) {
  GreedyLimits limits;
  limits.target = static_cast<size_t>(options.target_clusters);
  limits.max_rms = options.max_rms_m;
  limits.max_growth = options.max_merge_energy;
  return limits;
}

// Gives the ids 0, 1, ... in the order of the first faces.
int CompactLabels(int num_clusters, std::vector<int>* label) {
  std::vector<int> id(num_clusters, -1);
  int count = 0;
  for (int& l : *label) {
    if (id[l] < 0) id[l] = count++;
    l = id[l];
  }
  return count;
}

// Joining a neighbour that itself fell apart can leave a piece loose again, so
// this repeats; the last pass makes clusters of what is still loose.
int ConnectClusters(const TriMesh& mesh,
                    const FaceNeighbors& neighbors,
                    int num_clusters,
                    std::vector<int>* label,
                    int* loose_pieces) {
  constexpr int kPasses = 8;
  for (int pass = 1; pass <= kPasses; ++pass) {
    int loose = 0;
    num_clusters = SplitIntoPieces(
        mesh, neighbors, num_clusters, pass < kPasses, label, &loose);
    if (pass == 1) *loose_pieces = loose;
    if (loose == 0) break;
  }
  return num_clusters;
}

// Goes on with whole clusters: after the merges inside regions, and where
// clusters that fell apart have left more than were asked for.
void MergeClusters(const TriMesh& mesh,
                   const FaceNeighbors& neighbors,
                   const PartitionOptions& options,
                   int num_clusters,
                   std::vector<int>* label) {
  const std::vector<int> merged =
      MergeGreedily(Limits(options),
                    options.energy,
                    ClusterMoments(mesh, *label, num_clusters),
                    ClusterPairs(neighbors, *label));
  for (int& l : *label) l = merged[l];
}

int CountComponents(const std::vector<std::pair<int, int>>& face_pairs,
                    size_t num_faces) {
  UnionFind sets(num_faces);
  size_t components = num_faces;
  for (const auto& [f, g] : face_pairs) {
    const int a = sets.Find(f), b = sets.Find(g);
    if (a == b) continue;
    sets.Unite(a, b);
    --components;
  }
  return static_cast<int>(components);
}

// Every piece is a cluster at least. Where pieces are many, as specks of a
// fused scan can be, they must not use up the clusters of the others.
PartitionOptions MakeRoomForPieces(PartitionOptions options, int components) {
  options.target_clusters = std::max(options.target_clusters,
                                     components + options.target_clusters / 2);
  return options;
}

std::vector<SurfaceMoments> AllFaceMoments(const TriMesh& mesh) {
  std::vector<SurfaceMoments> moments(mesh.NumFaces());
  for (size_t f = 0; f < moments.size(); ++f) {
    moments[f] = FaceMoments(mesh, f);
  }
  return moments;
}

// In the mean, after the merges inside regions.
constexpr int kFacesPerCluster = 32;

bool IsLarge(const TriMesh& mesh, const PartitionOptions& options) {
  const int64_t faces = static_cast<int64_t>(mesh.NumFaces());
  return options.region_faces > 0 && faces > 4LL * options.region_faces &&
         faces >= 4LL * kFacesPerCluster * options.target_clusters;
}

}  // namespace

std::vector<SurfaceMoments> ClusterMoments(const TriMesh& mesh,
                                           const std::vector<int>& label,
                                           size_t num_clusters) {
  std::vector<SurfaceMoments> moments(num_clusters);
  for (size_t f = 0; f < mesh.NumFaces(); ++f) {
    SurfaceMoments& m = moments[label[f]];
    m = Union(m, FaceMoments(mesh, f));
  }
  return moments;
}

PlanarPartition PartitionMesh(const TriMesh& mesh,
                              const PartitionOptions& asked,
                              PartitionReport* report) {
  CheckOptions(asked);
  PartitionReport unused;
  if (!report) report = &unused;
  *report = PartitionReport();

  PlanarPartition partition;
  std::vector<int>& label = partition.face_cluster;
  std::vector<std::pair<int, int>> pairs = FacePairs(mesh);
  report->components = CountComponents(pairs, mesh.NumFaces());
  const PartitionOptions options = MakeRoomForPieces(asked, report->components);
  const bool large = IsLarge(mesh, options);
  if (large) {
    MergeInRegions(mesh,
                   std::move(pairs),
                   options.energy,
                   Limits(options),
                   options.region_faces,
                   kFacesPerCluster,
                   &label);
  } else {
    label = MergeGreedily(Limits(options),
                          options.energy,
                          AllFaceMoments(mesh),
                          std::move(pairs));
  }
  const FaceNeighbors neighbors = BuildFaceNeighbors(mesh);
  if (large) {
    MergeClusters(mesh, neighbors, options, NumLabels(label), &label);
  }
  report->greedy_clusters = NumLabels(label);

  SwapBorders(mesh, neighbors, options, &label, report);
  int count = ConnectClusters(
      mesh, neighbors, report->greedy_clusters, &label, &report->loose_pieces);
  if (count > options.target_clusters) {
    MergeClusters(mesh, neighbors, options, count, &label);
  }
  CompactLabels(count, &label);
  RefitClusters(mesh, &partition);
  report->rms_m = PartitionRms(mesh, partition);
  if (static_cast<size_t>(asked.target_clusters) > mesh.NumFaces()) {
    AddWarning("partition: the mesh has only " +
               std::to_string(mesh.NumFaces()) + " faces, fewer than the " +
               std::to_string(asked.target_clusters) +
               " clusters asked for: every face starts as a plane");
  }
  if (options.target_clusters > asked.target_clusters) {
    AddWarning("partition: the mesh has " + std::to_string(report->components) +
               " separate pieces, so it is divided into " +
               std::to_string(options.target_clusters) +
               " clusters instead of " + std::to_string(asked.target_clusters));
  }
  return partition;
}

void RefitClusters(const TriMesh& mesh, PlanarPartition* partition) {
  const int count = NumLabels(partition->face_cluster);
  const std::vector<SurfaceMoments> moments =
      ClusterMoments(mesh, partition->face_cluster, count);
  std::vector<Eigen::Vector3d> orientation(count, Eigen::Vector3d::Zero());
  partition->clusters.assign(count, PlaneCluster());
  for (size_t f = 0; f < mesh.NumFaces(); ++f) {
    const int c = partition->face_cluster[f];
    orientation[c] += mesh.FaceCross(f);
    ++partition->clusters[c].num_faces;
  }
  for (int c = 0; c < count; ++c) {
    PlaneCluster& cluster = partition->clusters[c];
    cluster.area = moments[c].area;
    cluster.centroid = moments[c].centroid;
    cluster.plane = FitPlane(moments[c], orientation[c]);
    cluster.rms = RmsToPlane(moments[c], cluster.plane);
  }
}

double PartitionRms(const TriMesh& mesh, const PlanarPartition& partition) {
  const std::vector<SurfaceMoments> moments =
      ClusterMoments(mesh, partition.face_cluster, partition.clusters.size());
  double square = 0, area = 0;
  for (size_t c = 0; c < moments.size(); ++c) {
    const double rms = RmsToPlane(moments[c], partition.clusters[c].plane);
    square += rms * rms * moments[c].area;
    area += moments[c].area;
  }
  return area > 0 ? std::sqrt(square / area) : 0;
}

}  // namespace facet
