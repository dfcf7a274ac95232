// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The steps of PartitionMesh. Internal to mesh/partition.h.
#pragma once

#include <utility>
#include <vector>

#include "mesh/edge_uses.h"
#include "mesh/greedy_merge.h"
#include "mesh/partition.h"

namespace facet {

inline SurfaceMoments FaceMoments(const TriMesh& mesh, size_t face) {
  const auto& f = mesh.faces[face];
  return TriangleMoments(
      mesh.vertices[f[0]], mesh.vertices[f[1]], mesh.vertices[f[2]]);
}

// The first merges of a large mesh: greedy ones inside regions of about
// `faces_per_region` faces that lie together, down to clusters of
// `faces_per_cluster` faces in the mean, on all threads. A region fits into
// caches, the queue of a whole scan does not. `pairs` is FacePairs(mesh).
// Returns the number of clusters.
int MergeInRegions(const TriMesh& mesh,
                   std::vector<std::pair<int, int>> pairs,
                   const ClusterEnergyOptions& energy,
                   GreedyLimits limits,
                   int faces_per_region,
                   int faces_per_cluster,
                   std::vector<int>* label);

// Gauss-Seidel swapping of border faces (method, Sec. 2.5): a face goes to the
// neighbouring cluster that lowers the sum of energies most. No cluster is
// emptied. Fills the swap fields of the report.
void SwapBorders(const TriMesh& mesh,
                 const FaceNeighbors& neighbors,
                 const PartitionOptions& options,
                 std::vector<int>* label,
                 PartitionReport* report);

// Splits clusters into their edge-connected pieces. The largest piece by area
// keeps its cluster; another one that touches a single other cluster joins
// that (if `absorb`), the rest become clusters of their own. Returns the new
// number of clusters and counts the pieces that were not the largest.
int SplitIntoPieces(const TriMesh& mesh,
                    const FaceNeighbors& neighbors,
                    int num_clusters,
                    bool absorb,
                    std::vector<int>* label,
                    int* loose_pieces);

// Pairs (low, high) of different clusters that share an edge: sorted, unique.
std::vector<std::pair<int, int>> ClusterPairs(const FaceNeighbors& neighbors,
                                              const std::vector<int>& label);

}  // namespace facet
