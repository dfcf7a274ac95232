// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Planes that follow the poses: the coordinates in which the joint solve gives
// its planes to Ceres.
//
// A plane and the poses that see it move together, R has a block for each such
// pair, and these are half of its numbers. With
//
//   phi = phi_0 [+] (u - u_0 - R_jj^-1 R_jp xi),   xi = Log(T T_0^-1)
//
// the plane goes by itself where the quadratic model about (T_0, phi_0) has its
// minimum for the given poses, and Ceres optimises the offset u from there. In
// (T, u) the rows of the plane are R_jj over u alone: the Jacobian becomes
// block-diagonal in the planes and its pose part R_pp, the factor of the Schur
// complement. The cost is that of (T, phi) at every point, not of the model.
//
// [+] is that of the formulation's plane manifold, and u has as many numbers as
// its tangent.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "costs/plane_manifold.h"
#include "problems/joint_system.h"

namespace facet {

class FollowingPlanes {
 public:
  // Offsets of zero at `state`, whose poses are read and whose planes are
  // written later on. It and the problem must outlive this.
  FollowingPlanes(const TextureProblem& problem, ReconState* state);

  int offset_size() const { return offset_size_; }
  double* offset(int plane) {
    return offsets_.data() + static_cast<ptrdiff_t>(offset_size_) * plane;
  }

  // Moves the planes of the state to where poses and offsets have them. False
  // if the manifold refuses a step.
  bool Place();

  // From now on the planes follow from the point of the moment, as `system`
  // predicts, whose planes are over `plane_basis`. Both must outlive the calls
  // of Place.
  void Follow(const JointSystem& system,
              const std::vector<PlaneBasis>& plane_basis);

  // d(basis coordinates of the plane) / du where it follows from, 3 columns.
  Eigen::Matrix<double, 3, Eigen::Dynamic> BasisFromOffset(int plane) const;

 private:
  const TextureProblem& problem_;
  ReconState* state_;
  std::vector<std::unique_ptr<ceres::Manifold>> manifolds_;  // by plane
  int offset_size_;
  std::vector<double> offsets_;                     // u
  std::vector<double> start_offsets_;               // u_0
  std::vector<double> start_planes_;                // phi_0
  std::vector<Pose> start_poses_;                   // T_0
  const JointSystem* system_ = nullptr;             // none yet: planes stay
  const std::vector<PlaneBasis>* basis_ = nullptr;  // of its rows
};

}  // namespace facet
