// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// bench-peer-open3d: Open3D's quadric error decimation with the defaults of its
// Python interface.
#include <open3d/utility/Logging.h>

#include <limits>
#include <memory>

#include "benchmarks/peers/open3d_mesh.h"
#include "benchmarks/peers/peer_run.h"

namespace facet {
namespace {

namespace o3d = open3d;

TriMesh FromPeer(const o3d::geometry::TriangleMesh& peer) {
  TriMesh mesh;
  mesh.vertices.assign(peer.vertices_.begin(), peer.vertices_.end());
  for (const Eigen::Vector3i& face : peer.triangles_) {
    mesh.faces.push_back({face[0], face[1], face[2]});
  }
  return mesh;
}

void Run(const PeerArgs& args) {
  o3d::utility::SetVerbosityLevel(o3d::utility::VerbosityLevel::Error);
  const o3d::geometry::TriangleMesh peer = ToOpen3d(ReadPeerMesh(args.input));
  const StageMeter meter;
  const std::shared_ptr<o3d::geometry::TriangleMesh> light =
      peer.SimplifyQuadricDecimation(
          args.count, std::numeric_limits<double>::infinity(), 1.0);
  meter.Print("simplify", light->triangles_.size());
  WriteSimplified(args.output, FromPeer(*light));
}

}  // namespace
}  // namespace facet

int main(int argc, char** argv) {
  return facet::RunPeer(argc, argv, {{"simplify"}}, facet::Run);
}
