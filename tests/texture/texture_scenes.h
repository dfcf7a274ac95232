// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Small meshes with known planes for the tests of the texture layer.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "mesh/planar_partition.h"
#include "mesh/tri_mesh.h"

namespace facet {

struct PlaneScene {
  TriMesh mesh;
  PlanarPartition partition;

  std::vector<Plane> Planes() const {
    std::vector<Plane> planes;
    for (const auto& cluster : partition.clusters) {
      planes.push_back(cluster.plane);
    }
    return planes;
  }
};

// Adds a grid of columns x rows quads spanned by `right` and `down` from
// `corner`, as one more cluster; its normal is down x right.
inline void AddQuadGrid(const Eigen::Vector3d& corner,
                        const Eigen::Vector3d& right,
                        const Eigen::Vector3d& down,
                        int columns,
                        int rows,
                        PlaneScene* scene) {
  const int base = static_cast<int>(scene->mesh.vertices.size());
  for (int r = 0; r <= rows; ++r) {
    for (int c = 0; c <= columns; ++c) {
      scene->mesh.vertices.push_back(corner + right * (1.0 * c / columns) +
                                     down * (1.0 * r / rows));
    }
  }
  const int id = static_cast<int>(scene->partition.clusters.size());
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < columns; ++c) {
      const int a = base + r * (columns + 1) + c, b = a + columns + 1;
      scene->mesh.faces.push_back({a, b, a + 1});
      scene->mesh.faces.push_back({a + 1, b, b + 1});
      scene->partition.face_cluster.push_back(id);
      scene->partition.face_cluster.push_back(id);
    }
  }
  PlaneCluster cluster;
  cluster.plane.normal = down.cross(right).normalized();
  cluster.centroid = corner + 0.5 * (right + down);
  cluster.plane.offset = -cluster.plane.normal.dot(cluster.centroid);
  cluster.area = down.cross(right).norm();
  cluster.num_faces = 2 * columns * rows;
  scene->partition.clusters.push_back(cluster);
}

}  // namespace facet
