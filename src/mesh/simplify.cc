// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "mesh/simplify.h"

#include <string>
#include <utility>

#include "mesh/adjacency.h"
#include "mesh/partition.h"
#include "mesh/simplify_internal.h"
#include "util/background.h"
#include "util/errors.h"

namespace facet {
namespace {

void CheckOptions(const SimplifyOptions& o) {
  const auto require = [](bool ok, const char* what) {
    if (!ok) throw OptionsError(std::string("simplification: ") + what);
  };
  require(o.inner_target >= 0, "inner_target must not be negative");
  require(o.border_ratio > 0 && o.border_ratio <= 1,
          "border_ratio must lie in (0, 1]");
  require(o.passes >= 1, "passes must be at least 1");
  require(o.target_faces >= 0, "target_faces must not be negative");
  require(o.target_faces > 0 || o.faces_per_m2 > 0,
          "faces_per_m2 must be positive");
  require(o.sweep_ratio == 0 || o.sweep_ratio >= 1,
          "sweep_ratio must be 0 or at least 1");
  require(o.max_cost_m4 > 0, "max_cost_m4 must be positive");
  require(o.free_error_m >= 0 && o.max_error_m > 0,
          "error bounds must be positive");
  require(o.cluster_plane_share >= 0 && o.cluster_plane_share <= 1,
          "cluster_plane_share must lie in [0, 1]");
  require(o.plane_reach_m >= 0, "plane_reach_m must not be negative");
  require(o.cluster_border_weight >= 0 && o.mesh_boundary_weight >= 0 &&
              o.point_share >= 0,
          "weights must not be negative");
  require(o.max_turn_deg > 0 && o.max_turn_deg < 90,
          "max_turn_deg must lie in (0, 90)");
  require(o.max_away_deg > 0 && o.max_away_deg <= 180,
          "max_away_deg must lie in (0, 180]");
  require(o.shape_penalty == 0 || o.shape_penalty >= 1,
          "shape_penalty must be 0 or at least 1");
}

int CountBorderEdges(const TriMesh& mesh, const std::vector<int>& labels) {
  int count = 0;
  for (const MeshEdge& edge : CollectEdges(mesh)) {
    count += IsBorder(edge, labels);
  }
  return count;
}

}  // namespace

SimplifyResult SimplifyByPlanes(const TriMesh& mesh,
                                const PlanarPartition& partition,
                                const SimplifyOptions& options) {
  return SimplifyInRegions(mesh, partition, options, kFacesPerRegion);
}

SimplifyResult SimplifyInRegions(const TriMesh& mesh,
                                 const PlanarPartition& partition,
                                 const SimplifyOptions& options,
                                 int faces_per_region) {
  CheckOptions(options);
  SimplifyResult result;
  SimplifyReport& report = result.report;
  report.faces_before = static_cast<int>(mesh.NumFaces());
  Background checks([&] {
    report.checks_before = CheckMesh(mesh);
    report.flipped_before = FindFlippedFaces(mesh, partition);
    report.border_edges_before = CountBorderEdges(mesh, partition.face_cluster);
  });

  Collapser collapser(mesh, partition, options, faces_per_region);
  if (options.stop == SimplifyStop::kCounts) {
    collapser.RunCounts();
  } else {
    collapser.RunBudget();
  }
  result.partition.clusters = partition.clusters;
  collapser.Extract(&result);
  if (!mesh.vertex_colors.empty()) {
    for (const int v : result.vertex_birth) {
      result.mesh.vertex_colors.push_back(mesh.vertex_colors[v]);
    }
  }

  PlanarPartition refit = result.partition;
  RefitClusters(result.mesh, &refit);
  result.refit = std::move(refit.clusters);
  for (size_t id = 0; id < result.refit.size(); ++id) {
    result.partition.clusters[id].num_faces = result.refit[id].num_faces;
  }
  report.checks_after = CheckMesh(result.mesh);
  report.faces_after = static_cast<int>(result.mesh.NumFaces());
  report.flipped_after = FindFlippedFaces(result.mesh, result.partition);
  report.border_edges_after =
      CountBorderEdges(result.mesh, result.partition.face_cluster);
  checks.Finish();
  return result;
}

}  // namespace facet
