// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// A partition of the faces of a mesh into clusters that lie close to a plane.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "geometry/plane.h"

namespace facet {

struct PlaneCluster {
  Plane plane;  // least-squares plane, oriented like the area of its faces
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();  // area-weighted [m]
  double area = 0;                                     // [m^2]
  double rms = 0;  // sqrt(n' Cov n / area), point to plane [m]
  int num_faces = 0;
};

struct PlanarPartition {
  std::vector<int> face_cluster;       // cluster id of every face, 0-based
  std::vector<PlaneCluster> clusters;  // by id
};

}  // namespace facet
