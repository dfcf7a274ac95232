// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Small labelled meshes for the tests of simplification and geometry.
#pragma once

#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include "mesh/partition.h"
#include "mesh/planar_partition.h"
#include "mesh/tri_mesh.h"

namespace facet {

struct LabelledMesh {
  TriMesh mesh;
  PlanarPartition partition;
};

// Adds an n x n grid over `at(u, v)`, u and v in [0, 1], with label `id`;
// neighbouring grids share vertices that are equal.
inline void AddGrid(int n,
                    int id,
                    const std::function<Eigen::Vector3d(double, double)>& at,
                    LabelledMesh* scene) {
  TriMesh& mesh = scene->mesh;
  std::vector<int> index;
  for (int i = 0; i <= n; ++i) {
    for (int k = 0; k <= n; ++k) {
      const Eigen::Vector3d p =
          at(static_cast<double>(k) / n, static_cast<double>(i) / n);
      int found = -1;
      for (size_t v = 0; v < mesh.NumVertices() && found < 0; ++v) {
        if ((mesh.vertices[v] - p).norm() < 1e-9) found = static_cast<int>(v);
      }
      if (found < 0) {
        found = static_cast<int>(mesh.NumVertices());
        mesh.vertices.push_back(p);
      }
      index.push_back(found);
    }
  }
  for (int i = 0; i < n; ++i) {
    for (int k = 0; k < n; ++k) {
      const int a = index[i * (n + 1) + k], b = index[i * (n + 1) + k + 1];
      const int c = index[(i + 1) * (n + 1) + k];
      const int d = index[(i + 1) * (n + 1) + k + 1];
      mesh.faces.push_back({a, b, d});
      mesh.faces.push_back({a, d, c});
      scene->partition.face_cluster.push_back(id);
      scene->partition.face_cluster.push_back(id);
    }
  }
}

// A closed cube of side 1 m, one label a side, normals outwards.
inline LabelledMesh MakeCube(int n) {
  LabelledMesh scene;
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 2; ++side) {
      AddGrid(
          n,
          2 * axis + side,
          [axis, side](double u, double v) {
            Eigen::Vector3d p;
            p[axis] = side;
            p[(axis + 1) % 3] = side ? u : v;
            p[(axis + 2) % 3] = side ? v : u;
            return p;
          },
          &scene);
    }
  }
  RefitClusters(scene.mesh, &scene.partition);
  return scene;
}

// An open sheet of 1 m, two labels side by side, z = height(x, y).
inline LabelledMesh MakeSheet(
    int n, const std::function<double(double, double)>& height) {
  LabelledMesh scene;
  for (int half = 0; half < 2; ++half) {
    AddGrid(
        n,
        half,
        [half, &height](double u, double v) {
          const double x = 0.5 * (u + half);
          return Eigen::Vector3d(x, v, height(x, v));
        },
        &scene);
  }
  RefitClusters(scene.mesh, &scene.partition);
  return scene;
}

}  // namespace facet
