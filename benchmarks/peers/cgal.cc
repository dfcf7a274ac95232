// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// bench-peer-cgal: two partitions of a mesh by CGAL.
//   vsa INPUT K OUTPUT              variational shape approximation, distance
//                                   to planes (L2), defaults of CGAL otherwise
//   region-growing INPUT N OUTPUT   regions of at least N faces within 2 cm
//                                   and 25 degrees of their plane, from the
//                                   flattest faces on
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Shape_detection/Region_growing/Region_growing.h>
#include <CGAL/Shape_detection/Region_growing/Region_growing_on_polygon_mesh.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_approximation/L2_metric_plane_proxy.h>
#include <CGAL/Variational_shape_approximation.h>

#include "benchmarks/peers/peer_run.h"
#include "mesh/mesh_io.h"
#include "util/errors.h"

namespace facet {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using PeerMesh = CGAL::Surface_mesh<Kernel::Point_3>;
using PointMap = boost::property_map<PeerMesh, CGAL::vertex_point_t>::type;

constexpr double kMaxDistanceM = 0.02;
constexpr double kMaxAngleDeg = 25;
constexpr int kVsaIterations = 20;  // as in approximate_triangle_mesh()

PeerMesh ToPeer(const TriMesh& mesh) {
  PeerMesh peer;
  peer.reserve(mesh.NumVertices(), 3 * mesh.NumFaces() / 2, mesh.NumFaces());
  for (const Eigen::Vector3d& v : mesh.vertices) {
    peer.add_vertex({v[0], v[1], v[2]});
  }
  for (const std::array<int, 3>& face : mesh.faces) {
    const auto added = peer.add_face(PeerMesh::Vertex_index(face[0]),
                                     PeerMesh::Vertex_index(face[1]),
                                     PeerMesh::Vertex_index(face[2]));
    if (added == PeerMesh::null_face()) {
      throw UnsolvableError("CGAL refuses a face of the mesh");
    }
  }
  return peer;
}

std::vector<int> Approximate(PeerMesh* peer, int num_proxies) {
  namespace vsa = CGAL::Surface_mesh_approximation;
  using Metric = vsa::L2_metric_plane_proxy<PeerMesh>;
  using Approximation =
      CGAL::Variational_shape_approximation<PeerMesh, PointMap, Metric>;
  std::vector<int> label(peer->number_of_faces());

  const StageMeter meter;
  const PointMap points = get(CGAL::vertex_point, *peer);
  const Metric metric(*peer, points);
  Approximation approximation(*peer, points, metric);
  approximation.initialize_seeds(
      CGAL::parameters::seeding_method(vsa::HIERARCHICAL)
          .max_number_of_proxies(num_proxies));
  approximation.run(kVsaIterations);
  auto proxy =
      peer->add_property_map<PeerMesh::Face_index, std::size_t>("f:proxy", 0)
          .first;
  approximation.proxy_map(proxy);
  for (const auto f : peer->faces()) label[f] = static_cast<int>(proxy[f]);
  meter.Print("vsa", approximation.number_of_proxies());
  return label;
}

std::vector<int> GrowRegions(const PeerMesh& peer, int min_faces) {
  namespace growing = CGAL::Shape_detection::Polygon_mesh;
  using Neighbors = growing::One_ring_neighbor_query<PeerMesh>;
  using Region = growing::Least_squares_plane_fit_region<Kernel, PeerMesh>;
  using Sorting =
      growing::Least_squares_plane_fit_sorting<Kernel, PeerMesh, Neighbors>;
  using Growing = CGAL::Shape_detection::Region_growing<PeerMesh::Face_range,
                                                        Neighbors,
                                                        Region,
                                                        Sorting::Seed_map>;
  std::vector<int> label(peer.number_of_faces(), -1);

  const StageMeter meter;
  const PointMap points = get(CGAL::vertex_point, peer);
  Neighbors neighbors(peer);
  Region region(peer, kMaxDistanceM, kMaxAngleDeg, min_faces, points);
  Sorting sorting(peer, neighbors, points);
  sorting.sort();
  const PeerMesh::Face_range faces = peer.faces();  // only referred to below
  Growing algorithm(faces, neighbors, region, sorting.seed_map());
  std::vector<std::vector<std::size_t>> regions;
  algorithm.detect(std::back_inserter(regions));
  for (std::size_t r = 0; r < regions.size(); ++r) {
    for (const std::size_t face : regions[r]) label[face] = static_cast<int>(r);
  }
  meter.Print("region-growing", regions.size());
  return label;
}

void Run(const PeerArgs& args) {
  PeerMesh peer = ToPeer(ReadPeerMesh(args.input));
  const std::vector<int> label = args.method == "vsa"
                                     ? Approximate(&peer, args.count)
                                     : GrowRegions(peer, args.count);
  WritePly(args.output, ReadPeerMesh(args.input), &label);
}

}  // namespace
}  // namespace facet

int main(int argc, char** argv) {
  return facet::RunPeer(argc, argv, {{"vsa", "region-growing"}}, facet::Run);
}
