// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// bench-peer-meshoptimizer: meshopt_simplify, which keeps vertices where they
// are, without a limit of the error.
#include <meshoptimizer.h>

#include "benchmarks/peers/peer_run.h"

namespace facet {
namespace {

void Run(const PeerArgs& args) {
  TriMesh mesh = ReadPeerMesh(args.input);
  std::vector<float> positions;
  positions.reserve(3 * mesh.NumVertices());
  for (const Eigen::Vector3d& v : mesh.vertices) {
    for (int i = 0; i < 3; ++i) positions.push_back(static_cast<float>(v[i]));
  }
  std::vector<unsigned> indices;
  indices.reserve(3 * mesh.NumFaces());
  for (const std::array<int, 3>& face : mesh.faces) {
    indices.insert(indices.end(), face.begin(), face.end());
  }
  const size_t num_vertices = mesh.NumVertices();
  mesh = TriMesh();

  const StageMeter meter;
  std::vector<unsigned> light(indices.size());
  light.resize(meshopt_simplify(light.data(),
                                indices.data(),
                                indices.size(),
                                positions.data(),
                                num_vertices,
                                3 * sizeof(float),
                                3 * static_cast<size_t>(args.count),
                                1e9F,
                                0,
                                nullptr));
  meter.Print("simplify", light.size() / 3);

  for (size_t v = 0; v < num_vertices; ++v) {
    mesh.vertices.emplace_back(
        positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]);
  }
  for (size_t i = 0; i < light.size(); i += 3) {
    mesh.faces.push_back({static_cast<int>(light[i]),
                          static_cast<int>(light[i + 1]),
                          static_cast<int>(light[i + 2])});
  }
  WriteSimplified(args.output, std::move(mesh));
}

}  // namespace
}  // namespace facet

int main(int argc, char** argv) {
  return facet::RunPeer(argc, argv, {{"simplify"}}, facet::Run);
}
