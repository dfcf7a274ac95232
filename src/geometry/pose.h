// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Rigid transforms and the exponential map of SE(3).
//
//   y = R x + t
//
// Naming: a Pose `b_from_a` maps points of frame a to frame b, so
// `c_from_a = c_from_b * b_from_a`. Twists are xi = (omega, upsilon): rotation
// vector [rad], then translation [m]; increments multiply from the left,
// T <- Exp(xi) T (method: local linearisation of the paper, Sec. 3.3).
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>

namespace facet {

using Vector6d = Eigen::Matrix<double, 6, 1>;

inline Eigen::Matrix3d Skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

struct Pose {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  Pose() = default;
  Pose(const Eigen::Quaterniond& q, const Eigen::Vector3d& t)
      : rotation(q.normalized()), translation(t) {}
  // From the upper 3x4 part; the rotation must be orthonormal.
  explicit Pose(const Eigen::Matrix4d& m)
      : rotation(Eigen::Quaterniond(Eigen::Matrix3d(m.topLeftCorner<3, 3>()))
                     .normalized()),
        translation(m.topRightCorner<3, 1>()) {}

  Eigen::Matrix3d RotationMatrix() const { return rotation.toRotationMatrix(); }

  Eigen::Matrix4d Matrix() const {
    Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
    m.topLeftCorner<3, 3>() = RotationMatrix();
    m.topRightCorner<3, 1>() = translation;
    return m;
  }

  Pose Inverse() const {
    const Eigen::Quaterniond inverse = rotation.conjugate();
    return Pose(inverse, -(inverse * translation));
  }

  // The origin of frame a in frame b's inverse: for cam_from_world the camera
  // centre in world coordinates.
  Eigen::Vector3d CenterInSource() const {
    return -(rotation.conjugate() * translation);
  }

  Eigen::Vector3d operator*(const Eigen::Vector3d& x) const {
    return rotation * x + translation;
  }
  Pose operator*(const Pose& other) const {
    return Pose(rotation * other.rotation,
                rotation * other.translation + translation);
  }
};

// Exp: twist (omega, upsilon) -> SE(3), exact.
inline Pose ExpSe3(const Vector6d& xi) {
  const Eigen::Vector3d omega = xi.head<3>();
  const Eigen::Vector3d upsilon = xi.tail<3>();
  const double theta = omega.norm();
  const Eigen::Matrix3d w = Skew(omega);
  Eigen::Quaterniond q;
  Eigen::Matrix3d v;
  if (theta < 1e-6) {
    q = Eigen::Quaterniond(
        1, 0.5 * omega.x(), 0.5 * omega.y(), 0.5 * omega.z());
    v = Eigen::Matrix3d::Identity() + 0.5 * w + w * w / 6.0;
  } else {
    q = Eigen::Quaterniond(Eigen::AngleAxisd(theta, omega / theta));
    const double half_sine = std::sin(0.5 * theta);  // 1 - cos without loss
    v = Eigen::Matrix3d::Identity() +
        2 * half_sine * half_sine / (theta * theta) * w +
        (theta - std::sin(theta)) / (theta * theta * theta) * w * w;
  }
  return Pose(q, v * upsilon);
}

// Log: inverse of ExpSe3 for rotation angles below pi.
inline Vector6d LogSe3(const Pose& pose) {
  Eigen::Quaterniond q = pose.rotation;
  if (q.w() < 0) q.coeffs() = -q.coeffs();
  const double sine = q.vec().norm();
  const double theta = 2.0 * std::atan2(sine, q.w());
  const Eigen::Vector3d omega = sine < 1e-9
                                    ? Eigen::Vector3d(2.0 * q.vec())
                                    : Eigen::Vector3d(theta / sine * q.vec());
  const Eigen::Matrix3d w = Skew(omega);
  Eigen::Matrix3d v_inverse = Eigen::Matrix3d::Identity() - 0.5 * w;
  if (theta < 1e-4) {
    v_inverse += w * w / 12.0;
  } else {
    const double half = 0.5 * theta;
    v_inverse += (1.0 - half * std::cos(half) / std::sin(half)) /
                 (theta * theta) * w * w;
  }
  Vector6d xi;
  xi << omega, v_inverse * pose.translation;
  return xi;
}

// Rotation angle of a pose, in radians in [0, pi].
inline double RotationAngle(const Pose& pose) {
  return 2.0 *
         std::atan2(pose.rotation.vec().norm(), std::abs(pose.rotation.w()));
}

}  // namespace facet
