// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "problems/joint_system.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "costs/plane_manifold.h"
#include "util/parallel_for.h"

namespace facet {
namespace {

// Relative shift of the diagonal: larger than for plain blocks, because the
// common part has been subtracted.
constexpr double kJointShift = 1e-5;
constexpr double kAbsoluteShift = 1e-12;
constexpr Eigen::Index kBlock = 60;  // rows that are factored together

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

// R of R^T R = A in place of A, both by their upper triangles, block row by
// block row; the blocks of a row on all threads. Below the diagonal, zeros stay
// zeros. False if A is not positive.
bool FactorInPlace(Eigen::MatrixXd* a) {
  const Eigen::Index n = a->rows();
  const auto size = [n](Eigen::Index begin) {
    return std::min(kBlock, n - begin);
  };
  for (Eigen::Index k = 0; k < n; k += kBlock) {
    auto corner = a->block(k, k, size(k), size(k));
    const Eigen::LLT<Eigen::MatrixXd, Eigen::Upper> llt(corner);
    if (llt.info() != Eigen::Success) return false;
    corner = llt.matrixU();
    const size_t num_right = (n - k - 1) / kBlock;
    ParallelFor(0, num_right, [&](size_t i) {
      const Eigen::Index j = k + kBlock * (static_cast<Eigen::Index>(i) + 1);
      auto panel = a->block(k, j, kBlock, size(j));
      corner.transpose().triangularView<Eigen::Lower>().solveInPlace(panel);
    });
    ParallelFor(0, num_right, [&](size_t i) {
      const Eigen::Index j = k + kBlock * (static_cast<Eigen::Index>(i) + 1);
      const Eigen::Index below = j + size(j) - k - kBlock;
      a->block(k + kBlock, j, below, size(j)).noalias() -=
          a->block(k, k + kBlock, kBlock, below).transpose() *
          a->block(k, j, kBlock, size(j));
    });
  }
  return true;
}

// Upper Cholesky factor of a symmetric matrix given by its upper triangle;
// raises the diagonal until it exists.
Eigen::MatrixXd UpperFactor(const Eigen::MatrixXd& upper) {
  const Eigen::Index n = upper.rows();
  Eigen::VectorXd diagonal = upper.diagonal();
  for (double shift = kJointShift;; shift *= 10) {
    Eigen::MatrixXd factor(n, n);
    ParallelForChunks(0, n, kBlock, [&](Eigen::Index begin, Eigen::Index end) {
      for (Eigen::Index i = begin; i < end; ++i) {
        factor.col(i).head(i) = upper.col(i).head(i);
        factor(i, i) = diagonal[i];
        factor.col(i).tail(n - i - 1).setZero();
      }
    });
    if (FactorInPlace(&factor)) return factor;
    for (Eigen::Index i = 0; i < diagonal.size(); ++i) {
      diagonal[i] += shift * std::abs(upper(i, i)) + kAbsoluteShift;
    }
  }
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
    rows.diagonal = UpperFactor(blocks.plane);
    rows.keyframes = std::move(blocks.keyframes);
    rows.poses = rows.diagonal.transpose().triangularView<Eigen::Lower>().solve(
        blocks.poses);
  });
  SubtractPlanes(system, problem.NumKeyframes(), &hessian.poses);
  system.poses = UpperFactor(hessian.poses);
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
