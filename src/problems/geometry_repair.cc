// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "problems/geometry_repair.h"

#include <algorithm>
#include <cmath>

namespace facet {
namespace {

constexpr double kMinArea = 1e-12;  // [m^2]

// Faces without area cannot be spoilt.
bool IsSpoilt(const Eigen::Vector3d& before,
              const Eigen::Vector3d& after,
              const Eigen::Vector3d& normal) {
  if (before.norm() < 2 * kMinArea) return false;
  return after.dot(before) <= 0 || after.norm() < 2 * kMinArea ||
         (after.dot(normal) <= 0 && before.dot(normal) > 0);
}

}  // namespace

int RepairFaces(const TriMesh& before,
                const PlanarPartition& labels,
                const std::vector<Plane>& planes,
                TriMesh* mesh) {
  const std::vector<Eigen::Vector3d> solved = mesh->vertices;
  std::vector<int> halvings(solved.size(), 0);
  for (bool again = true; again;) {
    again = false;
    std::vector<uint8_t> marked(solved.size(), 0);
    for (size_t f = 0; f < mesh->NumFaces(); ++f) {
      if (!IsSpoilt(before.FaceCross(f),
                    mesh->FaceCross(f),
                    planes[labels.face_cluster[f]].normal)) {
        continue;
      }
      for (const int v : mesh->faces[f]) {
        if (halvings[v] <= 5) marked[v] = again = true;
      }
    }
    for (size_t v = 0; v < solved.size(); ++v) {
      if (!marked[v]) continue;
      const double t = ++halvings[v] > 5 ? 0 : std::ldexp(1.0, -halvings[v]);
      mesh->vertices[v] =
          before.vertices[v] + t * (solved[v] - before.vertices[v]);
    }
  }
  return static_cast<int>(halvings.size() -
                          std::count(halvings.begin(), halvings.end(), 0));
}

void CountSpoiltFaces(const TriMesh& before,
                      const PlanarPartition& labels,
                      const std::vector<Plane>& planes,
                      const TriMesh& mesh,
                      GeometrySummary* summary) {
  for (size_t f = 0; f < mesh.NumFaces(); ++f) {
    const Eigen::Vector3d& normal = planes[labels.face_cluster[f]].normal;
    const Eigen::Vector3d old_cross = before.FaceCross(f);
    const Eigen::Vector3d new_cross = mesh.FaceCross(f);
    const bool had_area = old_cross.norm() >= 2 * kMinArea;
    summary->flipped_faces_before += had_area && old_cross.dot(normal) <= 0;
    summary->flipped_faces += had_area && new_cross.dot(normal) <= 0;
    summary->turned_faces += had_area && new_cross.dot(old_cross) <= 0;
    summary->degenerate_faces += had_area && new_cross.norm() < 2 * kMinArea;
  }
}

}  // namespace facet
