// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "problems/following_planes.h"

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

FollowingPlanes::FollowingPlanes(const TextureProblem& problem,
                                 ReconState* state)
    : problem_(problem), state_(state) {
  for (const Eigen::Vector3d& anchor : problem.anchors) {
    manifolds_.emplace_back(
        CreatePlaneManifold(problem.formulation.plane, anchor));
  }
  offset_size_ = manifolds_.empty() ? 0 : manifolds_[0]->TangentSize();
  offsets_.assign(manifolds_.size() * offset_size_, 0.0);
}

bool FollowingPlanes::Place() {
  if (!system_) return true;
  std::vector<Vector6d> xi;
  for (size_t k = 0; k < start_poses_.size(); ++k) {
    xi.push_back(LogSe3(state_->CamFromWorld(static_cast<int>(k)) *
                        start_poses_[k].Inverse()));
  }
  std::vector<char> placed(manifolds_.size());
  ParallelFor(0, manifolds_.size(), [&](size_t j) {
    const double* from = start_planes_.data() + kPlaneSize * j;
    RowMajorX minus(offset_size_, kPlaneSize);
    manifolds_[j]->MinusJacobian(from, minus.data());
    const size_t at = j * offset_size_;
    const Eigen::VectorXd step =
        Eigen::Map<const Eigen::VectorXd>(&offsets_[at], offset_size_) -
        Eigen::Map<const Eigen::VectorXd>(&start_offsets_[at], offset_size_) +
        minus * (*basis_)[j] * Prediction(system_->planes[j], xi);
    placed[j] = manifolds_[j]->Plus(
        from, step.data(), state_->planes.data() + kPlaneSize * j);
  });
  return std::all_of(
      placed.begin(), placed.end(), [](char ok) { return ok != 0; });
}

void FollowingPlanes::Follow(const JointSystem& system,
                             const std::vector<PlaneBasis>& plane_basis) {
  system_ = &system;
  basis_ = &plane_basis;
  start_offsets_ = offsets_;
  start_planes_ = state_->planes;
  start_poses_.clear();
  for (int k = 0; k < problem_.NumKeyframes(); ++k) {
    start_poses_.push_back(state_->CamFromWorld(k));
  }
}

Eigen::Matrix<double, 3, Eigen::Dynamic> FollowingPlanes::BasisFromOffset(
    int plane) const {
  RowMajorX plus(kPlaneSize, offset_size_);
  manifolds_[plane]->PlusJacobian(start_planes_.data() + kPlaneSize * plane,
                                  plus.data());
  return (*basis_)[plane].transpose() * plus;
}

}  // namespace facet
