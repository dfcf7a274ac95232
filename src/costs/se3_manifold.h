// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Camera poses as Ceres parameter blocks.
//
// Layout of a pose block, cam_from_world: (q_x, q_y, q_z, q_w, t_x, t_y, t_z).
// Increments xi = (omega, upsilon):
//
//   left        T <- Exp(xi) T, the local linearisation of the paper
//   (Sec. 3.3);
//               y = T q changes by omega x y + upsilon
//   right       T <- T Exp(xi): about the camera's axes seen from the world
//   quaternion  R and t apart: q <- Exp(2 omega) q, t <- t + upsilon
//
// Cost functions compute the Jacobian J_xi for the left increment and lift it
// to the ambient space, J = J_xi (P^T P)^-1 P^T with P = PlusJacobian of the
// left manifold: then J P = J_xi. The columns of the PlusJacobian P' of any
// other manifold over this layout lie in the range of P, P' = P A, so that J P'
// = J_xi A is its Jacobian without any code in the costs (method, Sec. 7.2).
#pragma once

#include <ceres/manifold.h>
#include <ceres/product_manifold.h>

#include <Eigen/Core>

#include "geometry/pose.h"

namespace facet {

inline constexpr int kPoseSize = 7;

enum class PoseKind { kLeft, kRight, kQuaternion };

class LeftSe3Manifold : public ceres::Manifold {
 public:
  int AmbientSize() const override { return kPoseSize; }
  int TangentSize() const override { return 6; }
  bool Plus(const double* x,
            const double* delta,
            double* x_plus_delta) const override;
  bool PlusJacobian(const double* x, double* jacobian) const override;
  bool Minus(const double* y,
             const double* x,
             double* y_minus_x) const override;
  bool MinusJacobian(const double* x, double* jacobian) const override;
};

class RightSe3Manifold : public ceres::Manifold {
 public:
  int AmbientSize() const override { return kPoseSize; }
  int TangentSize() const override { return 6; }
  bool Plus(const double* x,
            const double* delta,
            double* x_plus_delta) const override;
  bool PlusJacobian(const double* x, double* jacobian) const override;
  bool Minus(const double* y,
             const double* x,
             double* y_minus_x) const override;
  bool MinusJacobian(const double* x, double* jacobian) const override;
};

using QuaternionPoseManifold =
    ceres::ProductManifold<ceres::EigenQuaternionManifold,
                           ceres::EuclideanManifold<3>>;

// The caller, in general a ceres::Problem, owns the manifold.
ceres::Manifold* CreatePoseManifold(PoseKind kind);

// (P^T P)^-1 P^T of LeftSe3Manifold at x: 6 x 7, row-major. Lifts a row J_xi
// (1 x 6) to ambient coordinates: J = J_xi * lift.
using PoseLift = Eigen::Matrix<double, 6, kPoseSize, Eigen::RowMajor>;
PoseLift LeftPoseLift(const double* pose);

inline Pose PoseFromBlock(const double* block) {
  return Pose(Eigen::Quaterniond(block[3], block[0], block[1], block[2]),
              Eigen::Vector3d(block[4], block[5], block[6]));
}

inline void PoseToBlock(const Pose& pose, double* block) {
  Eigen::Map<Eigen::Vector4d> q(block);
  q = pose.rotation.coeffs();
  Eigen::Map<Eigen::Vector3d> t(block + 4);
  t = pose.translation;
}

}  // namespace facet
