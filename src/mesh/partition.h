// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Partition of a dense mesh into clusters close to planes (paper, Sec. 3.1;
// method, Sec. 2.1-2.6): greedy merging of faces by the PCA energy, swapping of
// faces along the borders, and repair of clusters that fell into several
// pieces. Every cluster of the result is connected through edges.
#pragma once

#include <string>

#include "mesh/cluster_energy.h"
#include "mesh/covariance.h"
#include "mesh/planar_partition.h"
#include "mesh/tri_mesh.h"

namespace facet {

struct PartitionOptions {
  // Merging stops at this many clusters, >= 1, or earlier by one of the two
  // limits below. A room needs 1000-3000.
  int target_clusters = 2000;
  // No union with a larger rms distance to its plane [m]; 0 = off. For scenes
  // of unknown size, e.g. 0.005 with target_clusters = 1.
  double max_rms_m = 0;
  // Stop when the cheapest union raises the energy by more [m^2]; 0 = off.
  double max_merge_energy = 0;

  ClusterEnergyOptions energy;

  // A mesh of more than four times as many faces is merged inside regions of at
  // most so many faces first, at the same time, until clusters have 32 faces in
  // the mean (of what is asked for at least four times as many); 0 = never.
  int region_faces = 500000;

  // Swap faces along borders as long as that lowers the sum of the energies...
  bool swap_borders = true;
  // ... through the whole front at most this often, >= 0 ...
  int max_swap_sweeps = 300;
  // ... and until a sweep lowers it by a smaller share.
  double min_swap_decrease = 1e-4;
};

struct PartitionReport {
  int components = 0;       // of the mesh, through edges
  int greedy_clusters = 0;  // after the first merging
  int swap_sweeps = 0;
  size_t swapped_faces = 0;  // moves made
  int loose_pieces = 0;      // split off clusters after swapping
  double greedy_energy = 0, swapped_energy = 0;  // sums over the clusters
  double rms_m = 0;                              // PartitionRms of the result
};

// The mesh must be clean (mesh/clean.h); non-manifold edges are allowed: all
// their faces are neighbours. Clusters come in the order of their first faces.
// With more pieces (connected components) than half of the target, there are as
// many clusters as pieces and half of the target (warning). Of a mesh with
// fewer faces than the target every face becomes a cluster (warning). Throws
// OptionsError for senseless options. The result does not depend on the number
// of threads. About 220 bytes a face beside the mesh, up to 2 million faces.
PlanarPartition PartitionMesh(const TriMesh& mesh,
                              const PartitionOptions& options,
                              PartitionReport* report = nullptr);

// The moments of every cluster (`label` by face), summed in the order of the
// faces.
std::vector<SurfaceMoments> ClusterMoments(const TriMesh& mesh,
                                           const std::vector<int>& label,
                                           size_t num_clusters);

// Recomputes area, centroid, plane, rms and face count of every cluster from
// face_cluster and the mesh: exact integrals. The number of clusters is that of
// the largest id + 1. Normals point to the side of the summed area vectors.
void RefitClusters(const TriMesh& mesh, PlanarPartition* partition);

// sqrt(sum_clusters n' Cov n / sum_clusters A): rms distance of the surface to
// the planes as they stand in the partition, by exact integrals [m]. For planes
// that do not pass through the centroid their offset counts too.
double PartitionRms(const TriMesh& mesh, const PlanarPartition& partition);

}  // namespace facet
