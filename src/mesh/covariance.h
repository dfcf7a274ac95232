// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Exact moments of pieces of surface: what a cluster needs to know to fit its
// plane and to be joined with another one. Method, Sec. 2.1.
//
//   A   = int dA                              [m^2]
//   c   = int x dA / A                        [m]
//   Cov = int (x - c)(x - c)' dA              [m^4]
//
// For a triangle Cov = A/12 sum_k (v_k - c)(v_k - c)'. The centred form is kept
// throughout: raw moments about a far origin lose the smallest eigenvalue.
#pragma once

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>

#include "geometry/plane.h"

namespace facet {

// 80 bytes; an empty piece is all zeros.
struct SurfaceMoments {
  double area = 0;
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  std::array<double, 6> cov{};  // xx, xy, xz, yy, yz, zz

  Eigen::Matrix3d Covariance() const {
    Eigen::Matrix3d m;
    m << cov[0], cov[1], cov[2], cov[1], cov[3], cov[4], cov[2], cov[4], cov[5];
    return m;
  }
  double Trace() const { return cov[0] + cov[3] + cov[5]; }
  double Determinant() const {
    return cov[0] * (cov[3] * cov[5] - cov[4] * cov[4]) -
           cov[1] * (cov[1] * cov[5] - cov[4] * cov[2]) +
           cov[2] * (cov[1] * cov[4] - cov[3] * cov[2]);
  }
};

// Cov += weight * d d'.
inline void AddOuter(double weight,
                     const Eigen::Vector3d& d,
                     std::array<double, 6>* cov) {
  (*cov)[0] += weight * d[0] * d[0];
  (*cov)[1] += weight * d[0] * d[1];
  (*cov)[2] += weight * d[0] * d[2];
  (*cov)[3] += weight * d[1] * d[1];
  (*cov)[4] += weight * d[1] * d[2];
  (*cov)[5] += weight * d[2] * d[2];
}

inline SurfaceMoments TriangleMoments(const Eigen::Vector3d& v0,
                                      const Eigen::Vector3d& v1,
                                      const Eigen::Vector3d& v2) {
  SurfaceMoments m;
  m.area = 0.5 * (v1 - v0).cross(v2 - v0).norm();
  m.centroid = (v0 + v1 + v2) / 3.0;
  for (const Eigen::Vector3d* v : {&v0, &v1, &v2}) {
    AddOuter(m.area / 12.0, *v - m.centroid, &m.cov);
  }
  return m;
}

// The moments of a and b together: Cov_a + Cov_b + A_a A_b / A d d' with
// d = c_a - c_b. Pieces without area add nothing.
inline SurfaceMoments Union(const SurfaceMoments& a, const SurfaceMoments& b) {
  if (!(b.area > 0)) return a;
  if (!(a.area > 0)) return b;
  SurfaceMoments m;
  m.area = a.area + b.area;
  const Eigen::Vector3d d = b.centroid - a.centroid;
  m.centroid = a.centroid + (b.area / m.area) * d;
  for (int k = 0; k < 6; ++k) m.cov[k] = a.cov[k] + b.cov[k];
  AddOuter(a.area * b.area / m.area, d, &m.cov);
  return m;
}

// The moments of a without its part b: the inverse of Union. Loses digits when
// little remains; sum up from scratch if less than 1e-3 of the area does.
inline SurfaceMoments Difference(const SurfaceMoments& a,
                                 const SurfaceMoments& b) {
  if (!(b.area > 0)) return a;
  SurfaceMoments m;
  m.area = a.area - b.area;
  if (!(m.area > 0)) return SurfaceMoments();
  m.centroid = a.centroid + (b.area / m.area) * (a.centroid - b.centroid);
  for (int k = 0; k < 6; ++k) m.cov[k] = a.cov[k] - b.cov[k];
  AddOuter(-m.area * b.area / a.area, m.centroid - b.centroid, &m.cov);
  return m;
}

// The least-squares plane through the centroid. `orientation` (the sum of the
// faces' area vectors) chooses the sign of the normal; if the normal is
// perpendicular to it, the sign is that of its largest component.
inline Plane FitPlane(const SurfaceMoments& m,
                      const Eigen::Vector3d& orientation) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(m.Covariance());
  Plane plane;
  plane.normal = solver.eigenvectors().col(0).normalized();
  double side = plane.normal.dot(orientation);
  if (side == 0) {
    Eigen::Index largest;
    plane.normal.cwiseAbs().maxCoeff(&largest);
    side = plane.normal[largest];
  }
  if (side < 0) plane.normal = -plane.normal;
  plane.offset = -plane.normal.dot(m.centroid);
  return plane;
}

// sqrt(n' Cov n / A + s(c)^2): rms distance of the piece to any plane [m].
inline double RmsToPlane(const SurfaceMoments& m, const Plane& plane) {
  if (!(m.area > 0)) return 0;
  const double height = plane.SignedDistance(m.centroid);
  const double spread =
      plane.normal.dot(m.Covariance() * plane.normal) / m.area;
  return std::sqrt(std::max(0.0, spread) + height * height);
}

// sqrt(mu_3 / A): rms distance to the least-squares plane [m].
inline double RmsHeight(const SurfaceMoments& m) {
  if (!(m.area > 0)) return 0;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(
      m.Covariance(), Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, solver.eigenvalues()[0]) / m.area);
}

}  // namespace facet
