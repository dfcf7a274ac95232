// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "mesh/clean.h"
#include "mesh/edge_uses.h"
#include "mesh/union_find.h"

namespace facet {
namespace {

// An edge is regular if one face has it, or two that run in opposite
// directions.
bool IsRegular(const TriMesh& mesh, const EdgeUse* uses, size_t count) {
  if (count == 1) return true;
  return count == 2 && uses[0].Forward(mesh) != uses[1].Forward(mesh);
}

// The angle about the edge from face `from` through the solid below it to face
// `to`, in (0, 2 pi).
double WedgeAngle(const TriMesh& mesh, const EdgeUse& from, const EdgeUse& to) {
  const Eigen::Vector3d axis =
      (mesh.vertices[from.high] - mesh.vertices[from.low]).normalized();
  const auto inward = [&](const EdgeUse& use) -> Eigen::Vector3d {
    const auto& f = mesh.faces[use.Face()];
    const Eigen::Vector3d d =
        mesh.vertices[f[(use.corner + 2) % 3]] - mesh.vertices[use.low];
    return (d - d.dot(axis) * axis).normalized();
  };
  const Eigen::Vector3d u = inward(from);
  const Eigen::Vector3d below = -mesh.FaceCross(from.Face()).normalized();
  const Eigen::Vector3d v = inward(to);
  const double angle = std::atan2(v.dot(below), v.dot(u));
  return angle > 0 ? angle : angle + 2 * M_PI;
}

using CornerPair = std::pair<int, int>;

// Which faces stay joined across an edge of many: forward with backward ones,
// smallest wedges first.
std::vector<CornerPair> PairFaces(const TriMesh& mesh,
                                  const EdgeUse* uses,
                                  size_t count) {
  struct Candidate {
    double angle;
    size_t i, j;
    bool operator<(const Candidate& other) const {
      if (angle != other.angle) return angle < other.angle;
      return i != other.i ? i < other.i : j < other.j;
    }
  };
  std::vector<Candidate> candidates;
  for (size_t i = 0; i < count; ++i) {
    for (size_t j = 0; j < count; ++j) {
      if (!uses[i].Forward(mesh) || uses[j].Forward(mesh)) continue;
      candidates.push_back({WedgeAngle(mesh, uses[i], uses[j]), i, j});
    }
  }
  std::sort(candidates.begin(), candidates.end());
  std::vector<char> taken(count, 0);
  std::vector<CornerPair> pairs;
  for (const Candidate& c : candidates) {
    if (taken[c.i] || taken[c.j]) continue;
    taken[c.i] = taken[c.j] = 1;
    pairs.emplace_back(uses[c.i].corner, uses[c.j].corner);
  }
  return pairs;
}

// The corner of the same vertex at the other end of the edge `corner`.
int NextCorner(int corner) { return corner % 3 == 2 ? corner - 2 : corner + 1; }

// Joins the fans at both ends of an edge that two faces share.
void JoinFans(const CornerPair& pair, UnionFind* fans) {
  // The faces run in opposite directions: one's start is the other's end.
  fans->Unite(pair.first, NextCorner(pair.second));
  fans->Unite(NextCorner(pair.first), pair.second);
}

// Joins across the regular edges, and across the others unless they are cut.
// `edge` counts the irregular ones.
UnionFind BuildFans(const TriMesh& mesh,
                    const std::vector<EdgeUse>& uses,
                    const std::vector<char>& cut) {
  UnionFind fans(3 * mesh.NumFaces());
  size_t irregular = 0;
  ForEachEdge(uses, [&](size_t begin, size_t end) {
    const size_t count = end - begin;
    if (IsRegular(mesh, &uses[begin], count)) {
      if (count == 2) {
        JoinFans({uses[begin].corner, uses[begin + 1].corner}, &fans);
      }
    } else if (!cut[irregular++]) {
      for (const auto& pair : PairFaces(mesh, &uses[begin], count)) {
        JoinFans(pair, &fans);
      }
    }
  });
  return fans;
}

// Cuts the irregular edges that would still have too many faces if every fan
// had its own vertex. An edge cut on all sides cannot: a fan has two ends, and
// runs along them in opposite directions. So this ends.
bool CutStubbornEdges(const TriMesh& mesh,
                      const std::vector<EdgeUse>& uses,
                      UnionFind* fans,
                      std::vector<char>* cut) {
  size_t irregular = 0;
  bool any = false;
  ForEachEdge(uses, [&](size_t begin, size_t end) {
    if (IsRegular(mesh, &uses[begin], end - begin)) return;
    char& is_cut = (*cut)[irregular++];
    if (is_cut) return;
    std::vector<std::array<int, 3>> halves;  // fans at the ends, direction
    for (size_t i = begin; i < end; ++i) {
      const int start = fans->Find(uses[i].corner);
      const int stop = fans->Find(NextCorner(uses[i].corner));
      if (uses[i].Forward(mesh)) {
        halves.push_back({start, stop, 0});
      } else {
        halves.push_back({stop, start, 1});
      }
    }
    std::sort(halves.begin(), halves.end());
    if (std::adjacent_find(halves.begin(), halves.end()) != halves.end()) {
      is_cut = 1;
      any = true;
    }
  });
  return any;
}

// Gives every fan but the first of a vertex a copy of it.
void SeparateFans(UnionFind* fans, TriMesh* mesh, SplitReport* report) {
  const bool colors = !mesh->vertex_colors.empty();
  std::vector<int> owner(mesh->NumVertices(), -1);  // fan that keeps the vertex
  std::vector<char> split(mesh->NumVertices(), 0);
  std::vector<int> copy(3 * mesh->NumFaces(), -1);  // by fan
  for (size_t f = 0; f < mesh->NumFaces(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const int fan = fans->Find(static_cast<int>(3 * f) + k);
      int& v = mesh->faces[f][k];
      if (copy[fan] < 0) {
        copy[fan] = v;
        if (owner[v] < 0) {
          owner[v] = fan;
        } else {
          copy[fan] = static_cast<int>(mesh->NumVertices());
          const Eigen::Vector3d position = mesh->vertices[v];
          mesh->vertices.push_back(position);
          if (colors) {
            const Rgb color = mesh->vertex_colors[v];
            mesh->vertex_colors.push_back(color);
          }
          report->split_vertices += !split[v];
          split[v] = 1;
          ++report->added_vertices;
        }
      }
      v = copy[fan];
    }
  }
}

}  // namespace

SplitReport SplitNonManifold(TriMesh* mesh) {
  SplitReport report;
  const std::vector<EdgeUse> uses = SortedEdgeUses(*mesh);
  ForEachEdge(uses, [&](size_t begin, size_t end) {
    report.non_manifold_edges += !IsRegular(*mesh, &uses[begin], end - begin);
  });
  std::vector<char> cut(report.non_manifold_edges, 0);
  UnionFind fans = BuildFans(*mesh, uses, cut);
  while (CutStubbornEdges(*mesh, uses, &fans, &cut)) {
    fans = BuildFans(*mesh, uses, cut);
  }
  SeparateFans(&fans, mesh, &report);
  return report;
}

}  // namespace facet
