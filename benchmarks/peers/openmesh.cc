// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// bench-peer-openmesh: OpenMesh's decimater with error quadrics and its guard
// against flipping normals, both with their defaults.
#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModNormalFlippingT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>

#include "benchmarks/peers/peer_run.h"
#include "util/errors.h"

namespace facet {
namespace {

using PeerMesh = OpenMesh::TriMesh_ArrayKernelT<>;
using Decimater = OpenMesh::Decimater::DecimaterT<PeerMesh>;
using Quadric = OpenMesh::Decimater::ModQuadricT<PeerMesh>;
using NormalFlipping = OpenMesh::Decimater::ModNormalFlippingT<PeerMesh>;

void ToPeer(const TriMesh& mesh, PeerMesh* peer) {
  peer->reserve(mesh.NumVertices(), 3 * mesh.NumFaces() / 2, mesh.NumFaces());
  for (const Eigen::Vector3d& v : mesh.vertices) {
    peer->add_vertex({static_cast<float>(v[0]),
                      static_cast<float>(v[1]),
                      static_cast<float>(v[2])});
  }
  for (const std::array<int, 3>& face : mesh.faces) {
    const auto added = peer->add_face(PeerMesh::VertexHandle(face[0]),
                                      PeerMesh::VertexHandle(face[1]),
                                      PeerMesh::VertexHandle(face[2]));
    if (!added.is_valid()) {
      throw UnsolvableError("OpenMesh refuses a face of the mesh");
    }
  }
  peer->request_face_normals();
  peer->update_face_normals();
}

TriMesh FromPeer(const PeerMesh& peer) {
  TriMesh mesh;
  for (const auto v : peer.all_vertices()) {
    const PeerMesh::Point& p = peer.point(v);
    mesh.vertices.emplace_back(p[0], p[1], p[2]);
  }
  for (const auto f : peer.faces()) {
    std::array<int, 3> face{};
    int corner = 0;
    for (const auto v : f.vertices()) face[corner++] = v.idx();
    mesh.faces.push_back(face);
  }
  return mesh;
}

void Run(const PeerArgs& args) {
  PeerMesh peer;
  peer.request_vertex_status();
  peer.request_edge_status();
  peer.request_halfedge_status();
  peer.request_face_status();
  ToPeer(ReadPeerMesh(args.input), &peer);

  const StageMeter meter;
  Decimater decimater(peer);
  OpenMesh::Decimater::ModHandleT<Quadric> quadric;
  OpenMesh::Decimater::ModHandleT<NormalFlipping> flipping;
  decimater.add(quadric);
  decimater.add(flipping);
  decimater.module(quadric).unset_max_err();
  if (!decimater.initialize()) {
    throw UnsolvableError("OpenMesh's decimater does not start");
  }
  decimater.decimate_to_faces(0, args.count);
  peer.garbage_collection();
  meter.Print("simplify", peer.n_faces());

  WriteSimplified(args.output, FromPeer(peer));
}

}  // namespace
}  // namespace facet

int main(int argc, char** argv) {
  return facet::RunPeer(argc, argv, {{"simplify"}}, facet::Run);
}
