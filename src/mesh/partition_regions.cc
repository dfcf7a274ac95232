// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

#include "mesh/greedy_merge.h"
#include "mesh/mesh_regions.h"
#include "mesh/partition_steps.h"
#include "util/parallel_for.h"

namespace facet {
namespace {

// Faces by the cell of a grid over the mesh that their first vertex is in,
// numbered in the order of the first faces.
std::vector<int> GridCells(const TriMesh& mesh) {
  constexpr int kCells = 64;  // along the longest side
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& v : mesh.vertices) box.extend(v);
  const double per_m = kCells / std::max(1e-9, box.sizes().maxCoeff());
  std::vector<int> id(kCells * kCells * kCells, -1), cells(mesh.NumFaces());
  int count = 0;
  for (size_t f = 0; f < cells.size(); ++f) {
    const Eigen::Vector3i at =
        ((mesh.vertices[mesh.faces[f][0]] - box.min()) * per_m)
            .cast<int>()
            .cwiseMin(kCells - 1);
    int& cell = id[(at[2] * kCells + at[1]) * kCells + at[0]];
    if (cell < 0) cell = count++;
    cells[f] = cell;
  }
  return cells;
}

// Where a face is: its region and its place among the faces of that.
struct Place {
  int region, index;
};

std::vector<Place> FindPlaces(const MeshRegions& regions) {
  std::vector<Place> places(regions.faces.size());
  for (int r = 0; r < regions.Count(); ++r) {
    for (int i = regions.begin[r]; i < regions.begin[r + 1]; ++i) {
      places[regions.faces[i]] = {r, i - regions.begin[r]};
    }
  }
  return places;
}

}  // namespace

int MergeInRegions(const TriMesh& mesh,
                   std::vector<std::pair<int, int>> pairs,
                   const ClusterEnergyOptions& energy,
                   GreedyLimits limits,
                   int faces_per_region,
                   int faces_per_cluster,
                   std::vector<int>* label) {
  const MeshRegions regions =
      DivideIntoRegions(mesh, GridCells(mesh), faces_per_region);
  const std::vector<Place> places = FindPlaces(regions);
  std::vector<std::vector<std::pair<int, int>>> inner(regions.Count());
  for (const auto& [f, g] : pairs) {
    const Place &a = places[f], &b = places[g];
    if (a.region == b.region) inner[a.region].push_back({a.index, b.index});
  }
  pairs = {};
  label->assign(mesh.NumFaces(), 0);
  std::vector<int> first(regions.Count() + 1, 0);
  ParallelFor(0, regions.Count(), [&](size_t r) {
    const int begin = regions.begin[r], end = regions.begin[r + 1];
    std::vector<SurfaceMoments> faces;
    faces.reserve(end - begin);
    for (int i = begin; i < end; ++i) {
      faces.push_back(FaceMoments(mesh, regions.faces[i]));
    }
    GreedyLimits own = limits;
    own.target = std::max(1, (end - begin) / faces_per_cluster);
    const std::vector<int> merged =
        MergeGreedily(own, energy, std::move(faces), std::move(inner[r]));
    for (int i = begin; i < end; ++i) {
      (*label)[regions.faces[i]] = merged[i - begin];
      first[r + 1] = std::max(first[r + 1], merged[i - begin] + 1);
    }
  });
  for (int r = 0; r < regions.Count(); ++r) first[r + 1] += first[r];
  for (size_t f = 0; f < label->size(); ++f) {
    (*label)[f] += first[places[f].region];
  }
  return first.back();
}

}  // namespace facet
