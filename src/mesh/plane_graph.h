// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Planes and their borders while they are being merged. Internal to
// mesh/merge.h.
#pragma once

#include <utility>
#include <vector>

#include "mesh/covariance.h"
#include "mesh/planar_partition.h"
#include "mesh/tri_mesh.h"

namespace facet {

// One plane of the graph, a union of clusters.
struct PlaneNode {
  bool alive = true;
  int version = 0;  // grows with every union
  SurfaceMoments moments;
  Eigen::Vector3d orientation = Eigen::Vector3d::Zero();  // sum of FaceCross
  PlaneCluster fit;           // plane, centroid, area, rms of the moments
  std::vector<int> members;   // original clusters
  std::vector<int> vertices;  // sorted
  int boundary_edges = 0;     // uses of edges on the mesh boundary
  std::vector<std::pair<int, int>> borders;  // (neighbour, edges), sorted
};

class PlaneGraph {
 public:
  PlaneGraph(const TriMesh& mesh, const PlanarPartition& partition);

  size_t size() const { return nodes_.size(); }
  const PlaneNode& node(int i) const { return nodes_[i]; }

  // Fit of the union of i and j, which stay as they are.
  PlaneCluster FitUnion(int i, int j) const;

  // j becomes part of i.
  void Unite(int i, int j);

  // Share of the inner edges that both their faces traverse in the same
  // direction: 0 for a consistently oriented mesh.
  double inconsistent_share() const { return inconsistent_share_; }

 private:
  void CollectVertices(const TriMesh& mesh, const std::vector<int>& label);
  void CollectBorders(const TriMesh& mesh, const std::vector<int>& label);

  std::vector<PlaneNode> nodes_;
  double inconsistent_share_ = 0;
};

}  // namespace facet
