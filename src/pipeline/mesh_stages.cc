// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "pipeline/mesh_stages.h"

#include "mesh/mesh_io.h"
#include "pipeline/report.h"
#include "util/errors.h"
#include "util/warnings.h"

namespace facet {
namespace {

CleanReport Clean(const ReconstructOptions& options, TriMesh* mesh) {
  try {
    return CleanMesh(options.clean, mesh);
  } catch (const InputError& e) {
    throw InputError(options.mesh_path + ": " + e.what());
  }
}

}  // namespace

MeshArtefact ReadDenseMesh(const ReconstructOptions& options) {
  MeshArtefact dense;
  dense.mesh = std::move(ReadMesh(options.mesh_path).mesh);
  const size_t faces = dense.mesh.NumFaces();
  const size_t vertices = dense.mesh.NumVertices();
  const CleanReport cleaned = Clean(options, &dense.mesh);
  const SplitReport split = SplitNonManifold(&dense.mesh);
  if (split.non_manifold_edges + split.split_vertices > 0) {
    AddWarning(options.mesh_path + ": opened " +
               std::to_string(split.non_manifold_edges) +
               " non-manifold edges and split " +
               std::to_string(split.split_vertices) + " non-manifold vertices");
  }
  dense.report = {{"input", {{"vertices", vertices}, {"faces", faces}}},
                  {"cleaning", cleaned.Summary()},
                  {"split_vertices", split.split_vertices}};
  return dense;
}

void PartitionDense(const ReconstructOptions& options, MeshArtefact* dense) {
  PartitionReport partition;
  const PlanarPartition clusters =
      PartitionMesh(dense->mesh, options.partition, &partition);
  MergeReport merge;
  dense->partition = MergePlanes(dense->mesh, clusters, options.merge, &merge);
  dense->report.update({{"clusters", clusters.clusters.size()},
                        {"rms_before_merging_m", partition.rms_m},
                        {"planes", dense->partition.clusters.size()},
                        {"rms_after_merging_m", merge.rms_m},
                        {"islands_absorbed", merge.islands}});
}

MeshArtefact SimplifyDense(const ReconstructOptions& options,
                           const MeshArtefact& dense) {
  SimplifyResult result =
      SimplifyByPlanes(dense.mesh, dense.partition, options.simplify);
  MeshArtefact light;
  light.mesh = std::move(result.mesh);
  light.partition = std::move(result.partition);
  for (const PlaneCluster& cluster : result.refit) {
    light.refitted_planes.push_back(cluster.plane);
  }
  light.mesh.vertex_colors.clear();
  if (!dense.mesh.vertex_colors.empty()) {
    for (const int birth : result.vertex_birth) {
      light.mesh.vertex_colors.push_back(dense.mesh.vertex_colors[birth]);
    }
  }
  light.report = SimplifyStageReport(result.report);
  return light;
}

}  // namespace facet
