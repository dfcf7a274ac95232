// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Planes n.x + w = 0 with unit normal n, and the projection onto them
// (paper, Eq. proj):
//
//   s = n.p + w          signed distance [m]
//   q = p - s n
//
// The optimiser keeps a plane as (n, d) about a fixed anchor c, the centroid of
// its cluster: s = n.(p - c) + d and w = d - n.c. Tilting about a far origin
// moves the plane by metres, about its own centroid by millimetres: the anchor
// decorrelates tilt and offset. Files store (n, w).
#pragma once

#include <Eigen/Core>

namespace facet {

struct Plane {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  // unit length
  double offset = 0;                                  // w [m]

  double SignedDistance(const Eigen::Vector3d& p) const {
    return normal.dot(p) + offset;
  }
  Eigen::Vector3d Project(const Eigen::Vector3d& p) const {
    return p - SignedDistance(p) * normal;
  }
};

// q = p - (n.(p - c) + d) n for any scalar type (Ceres Jets included).
//   plane   (n_x, n_y, n_z, d) with |n| = 1; d about `anchor` [m]
//   p       point in world [m];  anchor  c in world [m]
template <typename T>
Eigen::Matrix<T, 3, 1> ProjectOntoPlane(const T* plane,
                                        const Eigen::Vector3d& p,
                                        const Eigen::Vector3d& anchor) {
  const Eigen::Map<const Eigen::Matrix<T, 3, 1>> n(plane);
  const T s = n.dot((p - anchor).cast<T>()) + plane[3];
  return p.cast<T>() - s * n;
}

}  // namespace facet
