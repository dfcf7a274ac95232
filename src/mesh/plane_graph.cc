// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "mesh/plane_graph.h"

#include <algorithm>
#include <iterator>

#include "mesh/edge_uses.h"
#include "mesh/partition_steps.h"

namespace facet {
namespace {

using Borders = std::vector<std::pair<int, int>>;

PlaneCluster Fit(const SurfaceMoments& moments,
                 const Eigen::Vector3d& orientation) {
  PlaneCluster fit;
  fit.area = moments.area;
  fit.centroid = moments.centroid;
  fit.plane = FitPlane(moments, orientation);
  fit.rms = RmsToPlane(moments, fit.plane);
  return fit;
}

// Sorts by neighbour and adds up the edges of equal ones; drops neighbours i
// and j.
void Tidy(int i, int j, Borders* borders) {
  std::sort(borders->begin(), borders->end());
  size_t kept = 0;
  for (const auto& entry : *borders) {
    if (entry.first == i || entry.first == j) continue;
    if (kept > 0 && (*borders)[kept - 1].first == entry.first) {
      (*borders)[kept - 1].second += entry.second;
    } else {
      (*borders)[kept++] = entry;
    }
  }
  borders->resize(kept);
}

}  // namespace

PlaneGraph::PlaneGraph(const TriMesh& mesh, const PlanarPartition& partition)
    : nodes_(partition.clusters.size()) {
  const std::vector<int>& label = partition.face_cluster;
  const std::vector<SurfaceMoments> moments =
      ClusterMoments(mesh, label, nodes_.size());
  for (size_t f = 0; f < mesh.NumFaces(); ++f) {
    nodes_[label[f]].orientation += mesh.FaceCross(f);
  }
  for (size_t i = 0; i < nodes_.size(); ++i) {
    nodes_[i].moments = moments[i];
    nodes_[i].fit = Fit(moments[i], nodes_[i].orientation);
    nodes_[i].members = {static_cast<int>(i)};
  }
  CollectVertices(mesh, label);
  CollectBorders(mesh, label);
}

void PlaneGraph::CollectVertices(const TriMesh& mesh,
                                 const std::vector<int>& label) {
  std::vector<std::vector<int>> faces(nodes_.size());
  for (size_t f = 0; f < label.size(); ++f) {
    faces[label[f]].push_back(static_cast<int>(f));
  }
  std::vector<int> seen(mesh.NumVertices(), -1);
  for (size_t i = 0; i < nodes_.size(); ++i) {
    for (int f : faces[i]) {
      for (int v : mesh.faces[f]) {
        if (seen[v] == static_cast<int>(i)) continue;
        seen[v] = static_cast<int>(i);
        nodes_[i].vertices.push_back(v);
      }
    }
    std::sort(nodes_[i].vertices.begin(), nodes_[i].vertices.end());
  }
}

void PlaneGraph::CollectBorders(const TriMesh& mesh,
                                const std::vector<int>& label) {
  const std::vector<EdgeUse> uses = SortedEdgeUses(mesh);
  size_t inner = 0, inconsistent = 0;
  ForEachEdge(uses, [&](size_t begin, size_t end) {
    if (end - begin == 1) ++nodes_[label[uses[begin].Face()]].boundary_edges;
    if (end - begin == 2) {
      ++inner;
      inconsistent +=
          uses[begin].Forward(mesh) == uses[begin + 1].Forward(mesh);
    }
    for (size_t i = begin; i < end; ++i) {
      for (size_t j = begin; j < end; ++j) {
        const int a = label[uses[i].Face()], b = label[uses[j].Face()];
        if (a != b) nodes_[a].borders.emplace_back(b, 1);
      }
    }
  });
  for (PlaneNode& node : nodes_) Tidy(-1, -1, &node.borders);
  if (inner > 0) {
    inconsistent_share_ =
        static_cast<double>(inconsistent) / static_cast<double>(inner);
  }
}

PlaneCluster PlaneGraph::FitUnion(int i, int j) const {
  return Fit(Union(nodes_[i].moments, nodes_[j].moments),
             nodes_[i].orientation + nodes_[j].orientation);
}

void PlaneGraph::Unite(int i, int j) {
  PlaneNode& a = nodes_[i];
  PlaneNode& b = nodes_[j];
  for (const auto& [other, edges] : b.borders) {
    if (other == i) continue;
    Borders& borders = nodes_[other].borders;
    for (auto& entry : borders) {
      if (entry.first == j) entry.first = i;
    }
    Tidy(-1, -1, &borders);
  }
  a.fit = FitUnion(i, j);
  a.moments = Union(a.moments, b.moments);
  a.orientation += b.orientation;
  a.boundary_edges += b.boundary_edges;
  a.borders.insert(a.borders.end(), b.borders.begin(), b.borders.end());
  Tidy(i, j, &a.borders);
  a.members.insert(a.members.end(), b.members.begin(), b.members.end());
  std::vector<int> vertices;
  std::set_union(a.vertices.begin(),
                 a.vertices.end(),
                 b.vertices.begin(),
                 b.vertices.end(),
                 std::back_inserter(vertices));
  a.vertices = std::move(vertices);
  ++a.version;
  b = PlaneNode();
  b.alive = false;
}

}  // namespace facet
