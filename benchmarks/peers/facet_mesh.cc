// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// bench-facet-mesh: facet's own stages by its library, with its own defaults.
//   partition INPUT K OUTPUT   clusters
//   merge INPUT K OUTPUT       clusters merged to planes
//   simplify INPUT N OUTPUT    default clusters, merged, then N faces;
//                              N = 0: facet's own budget by area
//   simplify-near INPUT N OUTPUT  the same, near the dense surface rather than
//                              the planes
#include "benchmarks/peers/peer_run.h"
#include "mesh/merge.h"
#include "mesh/mesh_io.h"
#include "mesh/partition.h"
#include "mesh/simplify.h"

namespace facet {
namespace {

PlanarPartition Partition(const TriMesh& mesh,
                          const PartitionOptions& options) {
  const StageMeter meter;
  PlanarPartition clusters = PartitionMesh(mesh, options);
  meter.Print("partition", clusters.clusters.size());
  return clusters;
}

PlanarPartition Merge(const TriMesh& mesh, const PlanarPartition& clusters) {
  const StageMeter meter;
  PlanarPartition planes = MergePlanes(mesh, clusters, {});
  meter.Print("merge", planes.clusters.size());
  return planes;
}

void Run(const PeerArgs& args) {
  const TriMesh mesh = ReadPeerMesh(args.input);
  const bool near = args.method == "simplify-near";
  const bool simplify = near || args.method == "simplify";
  PartitionOptions options;
  if (!simplify) options.target_clusters = args.count;
  PlanarPartition planes = Partition(mesh, options);
  if (args.method != "partition") planes = Merge(mesh, planes);
  if (!simplify) {
    WritePly(args.output, mesh, &planes.face_cluster);
    return;
  }
  SimplifyOptions budget;
  budget.target_faces = args.count;
  if (near) budget.cluster_plane_share = 0;
  const StageMeter meter;
  const SimplifyResult light = SimplifyByPlanes(mesh, planes, budget);
  meter.Print("simplify", light.mesh.NumFaces());
  WriteSimplified(args.output, light.mesh);
}

}  // namespace
}  // namespace facet

int main(int argc, char** argv) {
  return facet::RunPeer(argc,
                        argv,
                        {{"partition", "merge", "simplify", "simplify-near"}},
                        facet::Run);
}
