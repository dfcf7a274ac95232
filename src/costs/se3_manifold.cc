// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "costs/se3_manifold.h"

#include <Eigen/Cholesky>

namespace facet {
namespace {

using PlusJacobianMatrix = Eigen::Matrix<double, kPoseSize, 6, Eigen::RowMajor>;

// d(Exp(xi) T)/dxi at 0: dq = 0.5 (omega, 0) q and dt = omega x t + upsilon.
PlusJacobianMatrix PlusJacobianAt(const double* x) {
  PlusJacobianMatrix p = PlusJacobianMatrix::Zero();
  const double qx = x[0], qy = x[1], qz = x[2], qw = x[3];
  p.topLeftCorner<4, 3>() << qw, qz, -qy,  //
      -qz, qw, qx,                         //
      qy, -qx, qw,                         //
      -qx, -qy, -qz;
  p.topLeftCorner<4, 3>() *= 0.5;
  p.bottomLeftCorner<3, 3>() = -Skew(Eigen::Vector3d(x[4], x[5], x[6]));
  p.bottomRightCorner<3, 3>().setIdentity();
  return p;
}

// d(T Exp(xi))/dxi at 0: dq = 0.5 q (omega, 0) and dt = R upsilon.
PlusJacobianMatrix RightPlusJacobianAt(const double* x) {
  PlusJacobianMatrix p = PlusJacobianMatrix::Zero();
  const double qx = x[0], qy = x[1], qz = x[2], qw = x[3];
  p.topLeftCorner<4, 3>() << qw, -qz, qy,  //
      qz, qw, -qx,                         //
      -qy, qx, qw,                         //
      -qx, -qy, -qz;
  p.topLeftCorner<4, 3>() *= 0.5;
  p.bottomRightCorner<3, 3>() = PoseFromBlock(x).RotationMatrix();
  return p;
}

// (P^T P)^-1 P^T.
PoseLift PseudoInverse(const PlusJacobianMatrix& p) {
  const Eigen::Matrix<double, 6, 6> gram = p.transpose() * p;
  return gram.ldlt().solve(p.transpose());
}

}  // namespace

bool LeftSe3Manifold::Plus(const double* x,
                           const double* delta,
                           double* x_plus_delta) const {
  const Eigen::Map<const Vector6d> xi(delta);
  PoseToBlock(ExpSe3(xi) * PoseFromBlock(x), x_plus_delta);
  return true;
}

bool LeftSe3Manifold::PlusJacobian(const double* x, double* jacobian) const {
  Eigen::Map<PlusJacobianMatrix> p(jacobian);
  p = PlusJacobianAt(x);
  return true;
}

bool LeftSe3Manifold::Minus(const double* y,
                            const double* x,
                            double* y_minus_x) const {
  Eigen::Map<Vector6d> xi(y_minus_x);
  xi = LogSe3(PoseFromBlock(y) * PoseFromBlock(x).Inverse());
  return true;
}

bool LeftSe3Manifold::MinusJacobian(const double* x, double* jacobian) const {
  Eigen::Map<PoseLift> m(jacobian);
  m = LeftPoseLift(x);
  return true;
}

bool RightSe3Manifold::Plus(const double* x,
                            const double* delta,
                            double* x_plus_delta) const {
  const Eigen::Map<const Vector6d> xi(delta);
  PoseToBlock(PoseFromBlock(x) * ExpSe3(xi), x_plus_delta);
  return true;
}

bool RightSe3Manifold::PlusJacobian(const double* x, double* jacobian) const {
  Eigen::Map<PlusJacobianMatrix> p(jacobian);
  p = RightPlusJacobianAt(x);
  return true;
}

bool RightSe3Manifold::Minus(const double* y,
                             const double* x,
                             double* y_minus_x) const {
  Eigen::Map<Vector6d> xi(y_minus_x);
  xi = LogSe3(PoseFromBlock(x).Inverse() * PoseFromBlock(y));
  return true;
}

bool RightSe3Manifold::MinusJacobian(const double* x, double* jacobian) const {
  Eigen::Map<PoseLift> m(jacobian);
  m = PseudoInverse(RightPlusJacobianAt(x));
  return true;
}

ceres::Manifold* CreatePoseManifold(PoseKind kind) {
  switch (kind) {
    case PoseKind::kLeft:
      return new LeftSe3Manifold;
    case PoseKind::kRight:
      return new RightSe3Manifold;
    case PoseKind::kQuaternion:
      return new QuaternionPoseManifold;
  }
  return nullptr;
}

PoseLift LeftPoseLift(const double* pose) {
  return PseudoInverse(PlusJacobianAt(pose));
}

}  // namespace facet
