// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The coordinates in which the joint solve gives poses and planes to Ceres:
// offsets from the point of the last linearisation (T_0, phi_0), where they
// were v_0 and u_0.
//
//   T   = T_0 [+] (v - v_0)
//   phi = phi_0 [+] (u - u_0 - R_jj^-1 R_jp xi),   xi = Log(T T_0^-1)
//
// **Planes follow the poses.** A plane and the poses that see it move together;
// R has a block for each such pair, and these are half of its numbers. But for
// given poses the quadratic model has its minimum over the plane where the
// second line has it for u = u_0, and Ceres optimises the offset from there. In
// (v, u) the rows of the plane are R_jj over u alone: the Jacobian becomes
// block-diagonal in the planes and its pose part R_pp, the factor of the Schur
// complement. The cost is that of (T, phi) at every point, not of the model.
//
// [+] is that of the formulation's manifolds; v has 6 numbers a pose, u as many
// a plane as the tangent of its manifold.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "costs/plane_manifold.h"
#include "costs/se3_manifold.h"
#include "problems/joint_system.h"

namespace facet {

class JointCoordinates {
 public:
  // Offsets of zero at `state`, whose poses, and with planes also planes, are
  // written from now on. It and the problem must outlive this.
  JointCoordinates(const TextureProblem& problem,
                   bool with_planes,
                   ReconState* state);

  bool with_planes() const { return !plane_manifolds_.empty(); }

  // v, consecutive poses one after the other.
  double* pose(int keyframe) { return poses_.data() + ptrdiff_t{6} * keyframe; }
  // u.
  double* plane(int plane) {
    return planes_.data() + static_cast<ptrdiff_t>(plane_size_) * plane;
  }
  int plane_size() const { return plane_size_; }

  // Moves the state to where the offsets have it. False if a manifold refuses a
  // step.
  bool Place();

  // The point of the moment becomes that of the last linearisation, with
  // `system` whose planes are over `plane_basis`. Both must outlive the calls
  // of Place.
  void Linearise(const JointSystem& system,
                 const std::vector<PlaneBasis>& plane_basis);

  // There: d(left increment of the pose) / dv, and d(basis coordinates of the
  // plane) / du, of 3 rows.
  const Eigen::Matrix<double, 6, 6>& LeftFromPose(int keyframe) const {
    return left_from_pose_[keyframe];
  }
  Eigen::Matrix<double, 3, Eigen::Dynamic> BasisFromPlane(int plane) const;

 private:
  bool PlacePlane(int plane, const std::vector<Vector6d>& xi);

  const TextureProblem& problem_;
  ReconState* state_;
  std::unique_ptr<ceres::Manifold> pose_manifold_;
  std::vector<std::unique_ptr<ceres::Manifold>> plane_manifolds_;
  int plane_size_ = 0;
  std::vector<double> poses_, planes_;        // v, u
  std::vector<double> at_poses_, at_planes_;  // v_0, u_0
  ReconState start_;                          // T_0, phi_0
  std::vector<Eigen::Matrix<double, 6, 6>> left_from_pose_;
  const JointSystem* system_ = nullptr;  // none yet: nothing has moved
  const std::vector<PlaneBasis>* basis_ = nullptr;  // of its rows
};

}  // namespace facet
