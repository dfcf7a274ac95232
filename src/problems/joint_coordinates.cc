// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "problems/joint_coordinates.h"

#include <algorithm>

#include "util/parallel_for.h"

namespace facet {
namespace {

using RowMajorX =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// -R_jj^-1 R_jp xi, over the basis.
Eigen::Vector3d Prediction(const JointPlaneRows& rows,
                           const std::vector<Vector6d>& xi) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (size_t a = 0; a < rows.keyframes.size(); ++a) {
    sum.noalias() -=
        rows.poses.middleCols<6>(6 * static_cast<Eigen::Index>(a)) *
        xi[rows.keyframes[a]];
  }
  rows.diagonal.triangularView<Eigen::Upper>().solveInPlace(sum);
  return sum;
}

}  // namespace

JointCoordinates::JointCoordinates(const TextureProblem& problem,
                                   bool with_planes,
                                   ReconState* state)
    : problem_(problem),
      state_(state),
      pose_manifold_(CreatePoseManifold(problem.formulation.manifold)),
      poses_(6 * static_cast<size_t>(problem.NumKeyframes()), 0.0) {
  if (!with_planes) return;
  for (const Eigen::Vector3d& anchor : problem.anchors) {
    plane_manifolds_.emplace_back(
        CreatePlaneManifold(problem.formulation.plane, anchor));
    plane_size_ = plane_manifolds_.back()->TangentSize();
  }
  planes_.assign(plane_manifolds_.size() * plane_size_, 0.0);
}

bool JointCoordinates::Place() {
  if (!system_) return true;
  std::vector<Vector6d> xi;
  for (int k = 0; k < problem_.NumKeyframes(); ++k) {
    const Eigen::Map<const Vector6d> v(&poses_[6 * k]), v0(&at_poses_[6 * k]);
    const Vector6d step = v - v0;
    const double* from = start_.poses.data() + kPoseSize * k;
    double* to = state_->poses.data() + kPoseSize * k;
    xi.push_back(Vector6d::Zero());
    if (step.isZero(0)) {  // exactly there, and not where rounding takes it
      std::copy(from, from + kPoseSize, to);
      continue;
    }
    if (!pose_manifold_->Plus(from, step.data(), to)) return false;
    xi.back() = LogSe3(PoseFromBlock(to) * PoseFromBlock(from).Inverse());
  }
  std::vector<char> placed(plane_manifolds_.size());
  ParallelFor(0, placed.size(), [&](size_t j) {
    placed[j] = PlacePlane(static_cast<int>(j), xi);
  });
  return std::all_of(
      placed.begin(), placed.end(), [](char ok) { return ok != 0; });
}

bool JointCoordinates::PlacePlane(int plane, const std::vector<Vector6d>& xi) {
  const ceres::Manifold& manifold = *plane_manifolds_[plane];
  const double* from = start_.planes.data() + kPlaneSize * plane;
  RowMajorX minus(plane_size_, kPlaneSize);
  manifold.MinusJacobian(from, minus.data());
  const int at = plane * plane_size_;
  const Eigen::Map<const Eigen::VectorXd> u(&planes_[at], plane_size_);
  const Eigen::Map<const Eigen::VectorXd> u0(&at_planes_[at], plane_size_);
  const Eigen::VectorXd step =
      u - u0 +
      minus * ((*basis_)[plane] * Prediction(system_->planes[plane], xi));
  double* to = state_->planes.data() + kPlaneSize * plane;
  if (step.isZero(0)) {
    std::copy(from, from + kPlaneSize, to);
    return true;
  }
  return manifold.Plus(from, step.data(), to);
}

void JointCoordinates::Linearise(const JointSystem& system,
                                 const std::vector<PlaneBasis>& plane_basis) {
  system_ = &system;
  basis_ = &plane_basis;
  at_poses_ = poses_;
  at_planes_ = planes_;
  start_.poses = state_->poses;
  start_.planes = state_->planes;
  left_from_pose_.clear();
  for (int k = 0; k < problem_.NumKeyframes(); ++k) {
    const double* pose = start_.poses.data() + kPoseSize * k;
    Eigen::Matrix<double, kPoseSize, 6, Eigen::RowMajor> plus;
    pose_manifold_->PlusJacobian(pose, plus.data());
    left_from_pose_.push_back(LeftPoseLift(pose) * plus);
  }
}

Eigen::Matrix<double, 3, Eigen::Dynamic> JointCoordinates::BasisFromPlane(
    int plane) const {
  RowMajorX plus(kPlaneSize, plane_size_);
  plane_manifolds_[plane]->PlusJacobian(
      start_.planes.data() + kPlaneSize * plane, plus.data());
  return (*basis_)[plane].transpose() * plus;
}

}  // namespace facet
