// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "benchmarks/peers/peer_quality.h"

#include <algorithm>

#include "mesh/partition.h"
#include "render/ray_scene.h"
#include "util/errors.h"
#include "util/parallel_for.h"

namespace facet {
namespace {

constexpr size_t kChunk = 1024;

double FlippedShare(const TriMesh& model,
                    const TriMesh& dense,
                    const MeshDistanceOptions& options) {
  const std::vector<SurfaceSample> samples =
      SampleSurface(model, options.num_points, options.seed);
  const RayScene scene(dense);
  std::vector<char> flipped(samples.size());
  ParallelForChunks(0, samples.size(), kChunk, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const int face = scene.NearestPoint(samples[i].point).face;
      flipped[i] =
          model.FaceCross(samples[i].face).dot(dense.FaceCross(face)) < 0;
    }
  });
  return static_cast<double>(std::count(flipped.begin(), flipped.end(), 1)) /
         static_cast<double>(flipped.size());
}

}  // namespace

SimplificationQuality MeasureSimplification(
    const TriMesh& model,
    const TriMesh& dense,
    const MeshDistanceOptions& options) {
  SimplificationQuality quality;
  quality.distance = CompareMeshes(model, dense, options);
  quality.checks = CheckMesh(model);
  quality.flipped_share = FlippedShare(model, dense, options);
  return quality;
}

PartitionQuality MeasurePartition(const TriMesh& mesh,
                                  const std::vector<int>& label) {
  TriMesh labelled;
  labelled.vertices = mesh.vertices;
  PlanarPartition partition;
  double area = 0, unlabelled_area = 0;
  for (size_t f = 0; f < mesh.NumFaces(); ++f) {
    area += mesh.FaceArea(f);
    if (label[f] < 0) {
      unlabelled_area += mesh.FaceArea(f);
      continue;
    }
    labelled.faces.push_back(mesh.faces[f]);
    partition.face_cluster.push_back(label[f]);
  }
  if (labelled.faces.empty()) {
    throw UnsolvableError("no face of the partition belongs to a cluster");
  }
  RefitClusters(labelled, &partition);
  PartitionQuality quality;
  quality.clusters = std::count_if(
      partition.clusters.begin(),
      partition.clusters.end(),
      [](const PlaneCluster& cluster) { return cluster.num_faces > 0; });
  quality.unlabelled_share = unlabelled_area / area;
  quality.rms_m = PartitionRms(labelled, partition);
  return quality;
}

}  // namespace facet
