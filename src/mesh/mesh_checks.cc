// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "mesh/mesh_checks.h"

#include <algorithm>
#include <numeric>
#include <vector>

#include "mesh/adjacency.h"

namespace facet {
namespace {

constexpr double kMinArea = 1e-12;  // [m^2]

// Disjoint sets over 0 .. n - 1; the root is the smallest member.
class DisjointSets {
 public:
  explicit DisjointSets(size_t n) : parent_(n) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  int Find(int i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void Join(int i, int k) {
    i = Find(i);
    k = Find(k);
    parent_[std::max(i, k)] = std::min(i, k);
  }

 private:
  std::vector<int> parent_;
};

// The corner (0, 1, 2) of `face` at `vertex`.
int CornerOf(const std::array<int, 3>& face, int vertex) {
  return face[0] == vertex ? 0 : face[1] == vertex ? 1 : 2;
}

// Corners joined through two-faced edges are one fan; counts the vertices with
// more than one, and those without any.
void CountFans(const TriMesh& mesh,
               const std::vector<MeshEdge>& edges,
               MeshChecks* checks) {
  DisjointSets fans(3 * mesh.NumFaces());
  for (const MeshEdge& edge : edges) {
    if (edge.num_faces != 2) continue;
    for (const int vertex : {edge.v0, edge.v1}) {
      fans.Join(3 * edge.face[0] + CornerOf(mesh.faces[edge.face[0]], vertex),
                3 * edge.face[1] + CornerOf(mesh.faces[edge.face[1]], vertex));
    }
  }
  std::vector<int> count(mesh.NumVertices(), 0);
  for (size_t c = 0; c < 3 * mesh.NumFaces(); ++c) {
    if (fans.Find(static_cast<int>(c)) == static_cast<int>(c)) {
      ++count[mesh.faces[c / 3][c % 3]];
    }
  }
  for (const int n : count) {
    checks->non_manifold_vertices += n > 1;
    checks->isolated_vertices += n == 0;
  }
}

void CountDuplicates(const TriMesh& mesh, MeshChecks* checks) {
  std::vector<std::array<int, 3>> keys = mesh.faces;
  for (auto& key : keys) std::sort(key.begin(), key.end());
  std::sort(keys.begin(), keys.end());
  for (size_t i = 1; i < keys.size(); ++i) {
    checks->duplicate_faces += keys[i] == keys[i - 1];
  }
}

}  // namespace

MeshChecks CheckMesh(const TriMesh& mesh) {
  MeshChecks checks;
  const std::vector<MeshEdge> edges = CollectEdges(mesh);
  CountFans(mesh, edges, &checks);
  CountDuplicates(mesh, &checks);
  for (size_t f = 0; f < mesh.NumFaces(); ++f) {
    const auto& face = mesh.faces[f];
    checks.degenerate_faces += face[0] == face[1] || face[1] == face[2] ||
                               face[2] == face[0] ||
                               !(mesh.FaceArea(f) >= kMinArea);
  }

  DisjointSets components(mesh.NumFaces());
  DisjointSets loops(mesh.NumVertices());
  std::vector<int> boundary_vertices;
  for (const MeshEdge& edge : edges) {
    checks.non_manifold_edges += edge.num_faces > 2;
    if (edge.num_faces >= 2) components.Join(edge.face[0], edge.face[1]);
    if (edge.num_faces == 1) {
      ++checks.boundary_edges;
      loops.Join(edge.v0, edge.v1);
      boundary_vertices.push_back(edge.v0);
      boundary_vertices.push_back(edge.v1);
    }
  }
  for (size_t f = 0; f < mesh.NumFaces(); ++f) {
    checks.components +=
        components.Find(static_cast<int>(f)) == static_cast<int>(f);
  }
  for (int& v : boundary_vertices) v = loops.Find(v);
  std::sort(boundary_vertices.begin(), boundary_vertices.end());
  checks.boundary_loops = static_cast<int>(
      std::unique(boundary_vertices.begin(), boundary_vertices.end()) -
      boundary_vertices.begin());
  checks.euler = static_cast<int>(mesh.NumVertices()) -
                 checks.isolated_vertices - static_cast<int>(edges.size()) +
                 static_cast<int>(mesh.NumFaces());
  return checks;
}

FlippedFaces FindFlippedFaces(const TriMesh& mesh,
                              const PlanarPartition& partition) {
  FlippedFaces flipped;
  double area = 0, flipped_area = 0;
  for (size_t f = 0; f < mesh.NumFaces(); ++f) {
    const Eigen::Vector3d cross = mesh.FaceCross(f);
    const double face_area = 0.5 * cross.norm();
    const auto& cluster = partition.clusters[partition.face_cluster[f]];
    area += face_area;
    if (face_area < kMinArea || cross.dot(cluster.plane.normal) > 0) continue;
    ++flipped.count;
    flipped_area += face_area;
  }
  if (area > 0) flipped.area_share = flipped_area / area;
  return flipped;
}

}  // namespace facet
