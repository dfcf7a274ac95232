// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "problems/joint_terms.h"

#include <algorithm>

#include "costs/plane_manifold.h"
#include "costs/se3_manifold.h"
#include "problems/gauge.h"
#include "problems/texture_problem.h"

namespace facet {
namespace {

// The columns of a plane's block that belong to a keyframe; new ones, zero, if
// it sees no texel of the plane.
auto ColumnsOf(int keyframe, JointPlaneBlocks* plane) {
  auto& keyframes = plane->keyframes;
  const auto where =
      std::lower_bound(keyframes.begin(), keyframes.end(), keyframe);
  const Eigen::Index at = 6 * (where - keyframes.begin());
  if (where == keyframes.end() || *where != keyframe) {
    const Eigen::Index after = plane->poses.cols() - at;
    keyframes.insert(where, keyframe);
    plane->poses.conservativeResize(Eigen::NoChange, at + 6 + after);
    plane->poses.rightCols(after) = plane->poses.middleCols(at, after).eval();
    plane->poses.middleCols<6>(at).setZero();
  }
  return plane->poses.middleCols<6>(at);
}

}  // namespace

JointTerms::JointTerms(const TextureProblem& problem,
                       const EnergyWeights& weights,
                       bool with_planes) {
  const TermBlocks terms(problem, weights);
  for (const TermBlock& term : terms.blocks()) {
    const bool plane_moves =
        term.plane >= 0 && with_planes && problem.plane_texels[term.plane] > 0;
    if (term.keyframe < 0 && !plane_moves) continue;
    const int rows = term.cost->num_residuals();
    blocks_.push_back({term, plane_moves, Eigen::VectorXd(rows), {}, {}});
    blocks_.back().by_pose.resize(rows, 6);
    blocks_.back().by_plane.resize(rows, 4);
  }
}

void JointTerms::HoldCommonMotion(const TextureProblem& problem, double e_c) {
  motion_.reset(CreateCommonMotionCost(problem.initial_cam_from_world,
                                       CommonMotionWeight(e_c)));
}

bool JointTerms::Evaluate(const ReconState& state) {
  const LeftSe3Manifold pose_manifold;
  Eigen::Matrix<double, kPoseSize, 6, Eigen::RowMajor> plus;
  Eigen::Matrix<double, Eigen::Dynamic, kPoseSize, Eigen::RowMajor> pose_j;
  Eigen::Matrix<double, Eigen::Dynamic, kPlaneSize, Eigen::RowMajor> plane_j;
  for (Block& block : blocks_) {
    pose_j.resize(block.residual.size(), kPoseSize);
    plane_j.resize(block.residual.size(), kPlaneSize);
    std::vector<const double*> parameters;
    std::vector<double*> jacobians;
    if (block.term.keyframe >= 0) {
      parameters.push_back(state.poses.data() +
                           kPoseSize * block.term.keyframe);
      jacobians.push_back(pose_j.data());
      pose_manifold.PlusJacobian(parameters.back(), plus.data());
    }
    if (block.term.plane >= 0) {
      parameters.push_back(state.planes.data() + kPlaneSize * block.term.plane);
      jacobians.push_back(plane_j.data());
    }
    if (!block.term.cost->Evaluate(
            parameters.data(), block.residual.data(), jacobians.data())) {
      return false;
    }
    if (block.term.keyframe >= 0) block.by_pose = pose_j * plus;
    if (block.term.plane >= 0) block.by_plane = plane_j;
  }
  return !motion_ || EvaluateMotion(state);
}

bool JointTerms::EvaluateMotion(const ReconState& state) {
  const size_t num_poses = motion_->parameter_block_sizes().size();
  std::vector<Eigen::Matrix<double, 6, kPoseSize, Eigen::RowMajor>> ambient(
      num_poses);
  std::vector<const double*> parameters;
  std::vector<double*> jacobians;
  for (size_t k = 0; k < num_poses; ++k) {
    parameters.push_back(state.poses.data() + kPoseSize * k);
    jacobians.push_back(ambient[k].data());
  }
  if (!motion_->Evaluate(
          parameters.data(), motion_residual_.data(), jacobians.data())) {
    return false;
  }
  motion_by_pose_.resize(6, 6 * static_cast<Eigen::Index>(num_poses));
  for (size_t k = 0; k < num_poses; ++k) {
    Eigen::Matrix<double, kPoseSize, 6, Eigen::RowMajor> plus;
    LeftSe3Manifold().PlusJacobian(parameters[k], plus.data());
    motion_by_pose_.middleCols<6>(6 * static_cast<Eigen::Index>(k)) =
        ambient[k] * plus;
  }
  return true;
}

double JointTerms::cost() const {
  double sum = motion_residual_.squaredNorm();
  for (const Block& block : blocks_) sum += block.residual.squaredNorm();
  return sum;
}

void JointTerms::AddGradient(JointGradient* gradient) const {
  for (size_t k = 0; motion_ && k < gradient->poses.size(); ++k) {
    gradient->poses[k] +=
        motion_by_pose_.middleCols<6>(6 * static_cast<Eigen::Index>(k))
            .transpose() *
        motion_residual_;
  }
  for (const Block& block : blocks_) {
    if (block.term.keyframe >= 0) {
      gradient->poses[block.term.keyframe] +=
          block.by_pose.transpose() * block.residual;
    }
    if (block.plane_moves) {
      gradient->planes[block.term.plane] +=
          block.by_plane.transpose() * block.residual;
    }
  }
}

void JointTerms::AddHessian(const std::vector<PlaneBasis>& plane_basis,
                            JointHessian* hessian) const {
  if (motion_) {
    hessian->poses.selfadjointView<Eigen::Upper>().rankUpdate(
        motion_by_pose_.transpose());
  }
  for (const Block& block : blocks_) {
    const int k = block.term.keyframe, j = block.term.plane;
    if (k >= 0) {
      hessian->poses.block<6, 6>(6 * k, 6 * k) +=
          block.by_pose.transpose() * block.by_pose;
    }
    if (!block.plane_moves) continue;
    JointPlaneBlocks& plane = hessian->planes[j];
    const Eigen::Matrix<double, Eigen::Dynamic, 3> rows =
        block.by_plane * plane_basis[j];
    plane.plane += rows.transpose() * rows;
    if (k >= 0) ColumnsOf(k, &plane) += rows.transpose() * block.by_pose;
  }
}

}  // namespace facet
