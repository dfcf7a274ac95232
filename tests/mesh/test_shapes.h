// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Small meshes whose right answers are known.
#pragma once

#include <cmath>
#include <functional>

#include "mesh/tri_mesh.h"
#include "util/random.h"

namespace facet {

// Appends an n x m grid over origin + [0, 1] u + [0, 1] v, facing u x v.
inline void AddGrid(const Eigen::Vector3d& origin,
                    const Eigen::Vector3d& u,
                    const Eigen::Vector3d& v,
                    int n,
                    int m,
                    TriMesh* mesh) {
  const int first = static_cast<int>(mesh->NumVertices());
  for (int j = 0; j <= m; ++j) {
    for (int i = 0; i <= n; ++i) {
      mesh->vertices.push_back(origin + u * i / n + v * j / m);
    }
  }
  for (int j = 0; j < m; ++j) {
    for (int i = 0; i < n; ++i) {
      const int a = first + j * (n + 1) + i;
      const int b = a + n + 1;
      mesh->faces.push_back({a, a + 1, b + 1});
      mesh->faces.push_back({a, b + 1, b});
    }
  }
}

// A box [0, size]^3 of six n x n grids, normals outward; the grids' common
// vertices are doubled: weld it with CleanMesh. Face f lies on side
// f / (2 n n).
inline TriMesh MakeBoxSoup(double size, int n) {
  TriMesh mesh;
  const Eigen::Vector3d x(size, 0, 0), y(0, size, 0), z(0, 0, size);
  const Eigen::Vector3d o = Eigen::Vector3d::Zero();
  AddGrid(o, y, x, n, n, &mesh);
  AddGrid(z, x, y, n, n, &mesh);
  AddGrid(o, x, z, n, n, &mesh);
  AddGrid(y, z, x, n, n, &mesh);
  AddGrid(o, z, y, n, n, &mesh);
  AddGrid(x, y, z, n, n, &mesh);
  return mesh;
}

// Moves every vertex by normal noise.
inline void AddNoise(double sigma, uint64_t seed, TriMesh* mesh) {
  Random random(seed);
  for (Eigen::Vector3d& v : mesh->vertices) {
    for (int k = 0; k < 3; ++k) v[k] += sigma * random.Normal();
  }
}

}  // namespace facet
