// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "problems/joint_system.h"

#include <utility>

#include "costs/plane_manifold.h"
#include "problems/dense_factor.h"
#include "util/parallel_for.h"

namespace facet {
namespace {

// Relative shift of the diagonal: larger than for plain blocks, because the
// common part has been subtracted.
constexpr double kJointShift = 1e-5;
constexpr double kAbsoluteShift = 1e-12;

template <typename Matrix>
void ShiftDiagonal(Matrix* h) {
  for (Eigen::Index i = 0; i < h->rows(); ++i) {
    (*h)(i, i) += kJointShift * (*h)(i, i) + kAbsoluteShift;
  }
}

// Eliminates the planes: S = H_pp - sum_j X_j' X_j, by block rows.
void SubtractPlanes(const JointSystem& system,
                    int num_keyframes,
                    Eigen::MatrixXd* s) {
  std::vector<std::vector<std::pair<int, int>>> rows(num_keyframes);
  for (size_t j = 0; j < system.planes.size(); ++j) {
    const auto& keyframes = system.planes[j].keyframes;
    for (size_t a = 0; a < keyframes.size(); ++a) {
      rows[keyframes[a]].push_back({static_cast<int>(j), static_cast<int>(a)});
    }
  }
  ParallelFor(0, rows.size(), [&](size_t i) {
    for (const auto& [j, a] : rows[i]) {
      const JointPlaneRows& plane = system.planes[j];
      const Eigen::Matrix<double, 6, 3> left =
          plane.poses.middleCols<6>(6 * a).transpose();
      for (size_t b = a; b < plane.keyframes.size(); ++b) {
        s->block<6, 6>(6 * i, 6 * plane.keyframes[b]) -=
            left * plane.poses.middleCols<6>(6 * b);
      }
    }
  });
}

}  // namespace

void LimitPlaneSteps(const TextureProblem& problem,
                     const JointPass& pass,
                     const ReconState& state,
                     const std::vector<PlaneBasis>& plane_basis,
                     double weight,
                     double plane_weight,
                     double max_tilt_rad,
                     double max_offset_m,
                     JointHessian* hessian) {
  const double tilt = 1 / (4 * max_tilt_rad * max_tilt_rad);
  const Eigen::Vector4d per_cost(
      tilt, tilt, tilt, 1 / (4 * max_offset_m * max_offset_m));
  for (size_t j = 0; j < plane_basis.size(); ++j) {
    const Eigen::Map<const Eigen::Vector4d> phi(state.planes.data() +
                                                kPlaneSize * j);
    const double cost = weight * pass.plane_squares[j] +
                        plane_weight * phi.dot(problem.moments[j] * phi);
    hessian->planes[j].plane += plane_basis[j].transpose() *
                                (cost * per_cost).asDiagonal() * plane_basis[j];
  }
}

JointSystem FactorJointSystem(const TextureProblem& problem,
                              JointHessian hessian,
                              const std::vector<PlaneBasis>& plane_basis,
                              double plane_weight) {
  ShiftDiagonal(&hessian.poses);
  JointSystem system;
  system.planes.resize(plane_basis.size());
  ParallelFor(0, plane_basis.size(), [&](size_t j) {
    JointPlaneRows& rows = system.planes[j];
    JointPlaneBlocks& blocks = hessian.planes[j];
    blocks.plane += plane_basis[j].transpose() *
                    (plane_weight * problem.moments[j]) * plane_basis[j];
    ShiftDiagonal(&blocks.plane);
    Eigen::MatrixXd diagonal = blocks.plane;
    FactorUpper(kJointShift, kAbsoluteShift, &diagonal);
    rows.diagonal = diagonal.triangularView<Eigen::Upper>();
    rows.keyframes = std::move(blocks.keyframes);
    rows.poses = rows.diagonal.transpose().triangularView<Eigen::Lower>().solve(
        blocks.poses);
  });
  SubtractPlanes(system, problem.NumKeyframes(), &hessian.poses);
  FactorUpper(kJointShift, kAbsoluteShift, &hessian.poses);
  system.poses = std::move(hessian.poses);
  return system;
}

JointGradient GradientOf(const TextureProblem& problem,
                         const JointPass& pass,
                         const ReconState& state,
                         double weight,
                         double plane_weight) {
  JointGradient gradient;
  for (const Vector6d& g : pass.pose_gradient) {
    gradient.poses.push_back(weight * g);
  }
  for (size_t j = 0; j < pass.plane_gradient.size(); ++j) {
    const Eigen::Map<const Eigen::Vector4d> phi(state.planes.data() +
                                                kPlaneSize * j);
    gradient.planes.push_back(weight * pass.plane_gradient[j] +
                              plane_weight * problem.moments[j] * phi);
  }
  return gradient;
}

void SetResiduals(const JointGradient& gradient,
                  const std::vector<PlaneBasis>& plane_basis,
                  JointSystem* system) {
  Eigen::VectorXd g(6 * static_cast<Eigen::Index>(gradient.poses.size()));
  for (size_t k = 0; k < gradient.poses.size(); ++k) {
    g.segment<6>(6 * static_cast<Eigen::Index>(k)) = gradient.poses[k];
  }
  system->explained = 0;
  for (size_t j = 0; j < system->planes.size(); ++j) {
    JointPlaneRows& rows = system->planes[j];
    rows.residual =
        rows.diagonal.transpose().triangularView<Eigen::Lower>().solve(
            plane_basis[j].transpose() * gradient.planes[j]);
    for (size_t a = 0; a < rows.keyframes.size(); ++a) {
      g.segment<6>(6 * rows.keyframes[a]) -=
          rows.poses.middleCols<6>(6 * a).transpose() * rows.residual;
    }
    system->explained += rows.residual.squaredNorm();
  }
  system->pose_residual =
      system->poses.transpose().triangularView<Eigen::Lower>().solve(g);
  system->explained += system->pose_residual.squaredNorm();
}

}  // namespace facet
