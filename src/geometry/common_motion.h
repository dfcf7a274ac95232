// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The rigid motion that two sets of camera poses have in common: how far a
// model slid as a whole, and what the gauge takes out (problems/gauge.h).
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "geometry/pose.h"

namespace facet {

// Least-squares rigid motion to ~ R from + t of corresponding columns (Umeyama
// 1991, without scale).
inline Pose AlignPoints(const Eigen::Matrix3Xd& from,
                        const Eigen::Matrix3Xd& to) {
  return Pose(Eigen::Matrix4d(Eigen::umeyama(from, to, false)));
}

// The rigid motion after_from_before, x' = R x + t in world coordinates, with
// how far it moves the centroid of the cameras and how far it turns them.
struct RigidMotion {
  Pose after_from_before;
  double mm = 0;
  double deg = 0;
};

// Camera centres and the points 1 m from them along the camera axes.
inline Eigen::Matrix3Xd CentersAndAxes(
    const std::vector<Pose>& cam_from_world) {
  Eigen::Matrix3Xd points(3, 4 * cam_from_world.size());
  for (size_t i = 0; i < cam_from_world.size(); ++i) {
    const Pose world_from_cam = cam_from_world[i].Inverse();
    points.col(4 * i) = world_from_cam.translation;
    for (int k = 0; k < 3; ++k) {
      points.col(4 * i + 1 + k) =
          world_from_cam * Eigen::Vector3d(Eigen::Vector3d::Unit(k));
    }
  }
  return points;
}

// Least squares over the camera centres and over points 1 m from them along the
// three camera axes, so that orientations count as much as positions and one
// camera alone determines it. This is the "slide" of a model that was optimised
// without anything that holds the gauge.
//   before, after  cam_from_world of the same cameras, equally many
// Without cameras the identity.
inline RigidMotion CommonMotion(const std::vector<Pose>& before,
                                const std::vector<Pose>& after) {
  RigidMotion result;
  if (before.empty()) return result;
  result.after_from_before =
      AlignPoints(CentersAndAxes(before), CentersAndAxes(after));
  Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
  for (const Pose& pose : before) centroid += pose.CenterInSource();
  centroid /= static_cast<double>(before.size());
  result.mm = 1000 * (result.after_from_before * centroid - centroid).norm();
  result.deg = RotationAngle(result.after_from_before) * 180 / 3.14159265358979;
  return result;
}

}  // namespace facet
