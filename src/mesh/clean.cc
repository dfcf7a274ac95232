// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "mesh/clean.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "mesh/union_find.h"
#include "util/errors.h"
#include "util/warnings.h"

namespace facet {
namespace {

// Drops the faces for which drop(face index) holds; returns how many.
template <typename Drop>
size_t DropFaces(const Drop& drop, TriMesh* mesh) {
  size_t kept = 0;
  for (size_t f = 0; f < mesh->NumFaces(); ++f) {
    if (!drop(f)) mesh->faces[kept++] = mesh->faces[f];
  }
  const size_t dropped = mesh->NumFaces() - kept;
  mesh->faces.resize(kept);
  return dropped;
}

void DropBadCorners(TriMesh* mesh, CleanReport* report) {
  const int count = static_cast<int>(mesh->NumVertices());
  report->bad_index_faces = DropFaces(
      [&](size_t f) {
        for (int v : mesh->faces[f]) {
          if (v < 0 || v >= count) return true;
        }
        return false;
      },
      mesh);
  std::vector<char> finite(mesh->NumVertices());
  for (size_t v = 0; v < finite.size(); ++v) {
    finite[v] = mesh->vertices[v].allFinite();
    report->non_finite_vertices += !finite[v];
  }
  report->non_finite_faces = DropFaces(
      [&](size_t f) {
        const auto& corners = mesh->faces[f];
        return !(finite[corners[0]] && finite[corners[1]] &&
                 finite[corners[2]]);
      },
      mesh);
}

// Points the faces at the first of equal vertices.
void Weld(double tolerance, TriMesh* mesh, CleanReport* report) {
  const auto key = [&](int v) -> Eigen::Vector3d {
    const Eigen::Vector3d& x = mesh->vertices[v];
    if (tolerance == 0) return x;
    return (x / tolerance).array().round();
  };
  std::vector<int> order;
  order.reserve(mesh->NumVertices());
  for (size_t v = 0; v < mesh->NumVertices(); ++v) {
    if (mesh->vertices[v].allFinite()) order.push_back(static_cast<int>(v));
  }
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    const Eigen::Vector3d x = key(a), y = key(b);
    for (int k = 0; k < 3; ++k) {
      if (x[k] != y[k]) return x[k] < y[k];
    }
    return a < b;
  });
  std::vector<int> target(mesh->NumVertices());
  std::iota(target.begin(), target.end(), 0);
  for (size_t i = 1; i < order.size(); ++i) {
    if (key(order[i]) != key(order[i - 1])) continue;
    target[order[i]] = target[order[i - 1]];
    ++report->welded_vertices;
  }
  if (report->welded_vertices == 0) return;
  for (auto& face : mesh->faces) {
    for (int& v : face) v = target[v];
  }
}

void DropDuplicates(TriMesh* mesh, CleanReport* report) {
  struct Key {
    std::array<int, 3> corners;
    int face;
    bool operator<(const Key& other) const {
      return corners != other.corners ? corners < other.corners
                                      : face < other.face;
    }
  };
  std::vector<Key> keys(mesh->NumFaces());
  for (size_t f = 0; f < keys.size(); ++f) {
    keys[f] = {mesh->faces[f], static_cast<int>(f)};
    std::sort(keys[f].corners.begin(), keys[f].corners.end());
  }
  std::sort(keys.begin(), keys.end());
  std::vector<char> duplicate(keys.size(), 0);
  for (size_t i = 1; i < keys.size(); ++i) {
    duplicate[keys[i].face] = keys[i].corners == keys[i - 1].corners;
  }
  report->duplicate_faces =
      DropFaces([&](size_t f) { return duplicate[f] != 0; }, mesh);
}

void DropSmallComponents(int min_faces, TriMesh* mesh, CleanReport* report) {
  UnionFind sets(mesh->NumVertices());
  for (const auto& f : mesh->faces) {
    sets.Unite(f[0], f[1]);
    sets.Unite(f[0], f[2]);
  }
  std::vector<int> faces(mesh->NumVertices(), 0);
  int largest = 0;
  for (const auto& f : mesh->faces) {
    largest = std::max(largest, ++faces[sets.Find(f[0])]);
  }
  min_faces = std::min(min_faces, largest);
  for (int count : faces) {
    report->small_components += count > 0 && count < min_faces;
  }
  report->small_component_faces = DropFaces(
      [&](size_t f) { return faces[sets.Find(mesh->faces[f][0])] < min_faces; },
      mesh);
}

void DropUnreferenced(TriMesh* mesh, CleanReport* report) {
  std::vector<int> place(mesh->NumVertices(), -1);
  for (const auto& f : mesh->faces) {
    for (int v : f) place[v] = 0;
  }
  const bool colors = mesh->vertex_colors.size() == mesh->NumVertices();
  int kept = 0;
  for (size_t v = 0; v < place.size(); ++v) {
    if (place[v] < 0) continue;
    mesh->vertices[kept] = mesh->vertices[v];
    if (colors) mesh->vertex_colors[kept] = mesh->vertex_colors[v];
    place[v] = kept++;
  }
  // Welded and not finite vertices are counted as such.
  report->unreferenced_vertices = mesh->NumVertices() - kept -
                                  report->non_finite_vertices -
                                  report->welded_vertices;
  mesh->vertices.resize(kept);
  if (colors) mesh->vertex_colors.resize(kept);
  for (auto& face : mesh->faces) {
    for (int& v : face) v = place[v];
  }
}

void CheckUnits(const CleanOptions& options,
                const TriMesh& mesh,
                CleanReport* report) {
  Eigen::Vector3d low = mesh.vertices[0], high = low;
  for (const Eigen::Vector3d& x : mesh.vertices) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  report->diagonal_m = (high - low).norm();
  if (report->diagonal_m < options.min_diagonal_m ||
      report->diagonal_m > options.max_diagonal_m) {
    AddWarning("the mesh measures " + std::to_string(report->diagonal_m) +
               " m from corner to corner; is it in metres?");
  }
}

void CheckOptions(const CleanOptions& options) {
  if (!(options.weld_tolerance_m >= 0) || !(options.min_face_area_m2 >= 0) ||
      options.min_component_faces < 0) {
    throw OptionsError(
        "cleaning: weld_tolerance_m, min_face_area_m2 and min_component_faces "
        "must not be negative");
  }
}

}  // namespace

std::string CleanReport::Summary() const {
  const std::pair<size_t, const char*> parts[] = {
      {non_finite_vertices, "vertices that are not finite"},
      {bad_index_faces, "faces with indices out of range"},
      {non_finite_faces, "faces with corners that are not finite"},
      {welded_vertices, "vertices equal to another one"},
      {repeated_index_faces, "faces with a repeated vertex"},
      {zero_area_faces, "faces without area"},
      {duplicate_faces, "duplicate faces"},
      {small_component_faces, "faces of small loose pieces"},
      {unreferenced_vertices, "unreferenced vertices"}};
  std::string text;
  for (const auto& [count, name] : parts) {
    if (count == 0) continue;
    text +=
        (text.empty() ? "removed " : ", ") + std::to_string(count) + " " + name;
  }
  return text.empty() ? "nothing to clean" : text;
}

CleanReport CleanMesh(const CleanOptions& options, TriMesh* mesh) {
  CheckOptions(options);
  CleanReport report;
  DropBadCorners(mesh, &report);
  Weld(options.weld_tolerance_m, mesh, &report);
  report.repeated_index_faces = DropFaces(
      [&](size_t f) {
        const auto& v = mesh->faces[f];
        return v[0] == v[1] || v[1] == v[2] || v[2] == v[0];
      },
      mesh);
  report.zero_area_faces = DropFaces(
      [&](size_t f) {
        return !(mesh->FaceArea(f) >= options.min_face_area_m2);
      },
      mesh);
  DropDuplicates(mesh, &report);
  const size_t broken = report.RemovedFaces();
  if (options.min_component_faces > 0) {
    DropSmallComponents(options.min_component_faces, mesh, &report);
  }
  DropUnreferenced(mesh, &report);
  if (mesh->faces.empty()) {
    throw InputError("no face of the mesh is left after cleaning (" +
                     report.Summary() + "); give a mesh with valid faces");
  }
  CheckUnits(options, *mesh, &report);
  if (broken > 0 || report.non_finite_vertices > 0) {
    AddWarning("mesh cleaning: " + report.Summary());
  }
  return report;
}

}  // namespace facet
