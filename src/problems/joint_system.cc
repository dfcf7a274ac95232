// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "problems/joint_system.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "costs/plane_manifold.h"
#include "util/parallel_for.h"

namespace facet {
namespace {

using PlaneBasis = Eigen::Matrix<double, 4, 3>;

// Blocks of H before factoring.
struct Blocks {
  Eigen::MatrixXd pose_pose;  // upper triangle
  std::vector<Eigen::Matrix3d> plane_plane;
  std::vector<std::vector<int>> plane_keyframes;
  std::vector<Eigen::Matrix<double, 3, Eigen::Dynamic>> plane_pose;
};

// For each keyframe the segments that belong to it, as (tile, segment).
std::vector<std::vector<std::pair<uint32_t, uint32_t>>> SegmentsByFrame(
    const TextureProblem& problem) {
  std::vector<std::vector<std::pair<uint32_t, uint32_t>>> by_frame(
      problem.NumKeyframes());
  for (size_t t = 0; t < problem.tiles.size(); ++t) {
    for (size_t s = problem.tiles[t].segment_begin;
         s < problem.tiles[t].segment_end; ++s) {
      by_frame[problem.segments[s].keyframe].push_back(
          {static_cast<uint32_t>(t), static_cast<uint32_t>(s)});
    }
  }
  return by_frame;
}

// Block row i of the pose part, written by one task alone:
//   H_ii += c_i B_i' T B_i,  H_ik -= kappa c_i c_k / sum(c) B_i' T B_k.
void AddPoseRows(const TextureProblem& problem,
                 const JointPass& pass,
                 const std::vector<double>& share_sum,
                 double weight,
                 double common_share,
                 Eigen::MatrixXd* h) {
  const auto by_frame = SegmentsByFrame(problem);
  ParallelFor(0, by_frame.size(), [&](size_t i) {
    for (const auto& [t, s] : by_frame[i]) {
      const TexelTile& tile = problem.tiles[t];
      const TileView& view = pass.views[s];
      const Eigen::Matrix<float, 6, 2> bt =
          view.pose_shift.transpose() * pass.tensors[t] *
          static_cast<float>(weight * view.share);
      h->block<6, 6>(6 * i, 6 * i) += (bt * view.pose_shift).cast<double>();
      const float scale = static_cast<float>(common_share / share_sum[t]);
      for (size_t other = s; other < tile.segment_end; ++other) {
        const TileView& second = pass.views[other];
        const int k = problem.segments[other].keyframe;
        h->block<6, 6>(6 * i, 6 * k) -=
            (bt * (scale * second.share) * second.pose_shift).cast<double>();
      }
    }
  });
}

// Plane blocks, by plane.
void AddPlaneBlocks(const TextureProblem& problem,
                    const JointPass& pass,
                    const std::vector<double>& share_sum,
                    const std::vector<PlaneBasis>& basis,
                    double weight,
                    double common_share,
                    Blocks* blocks) {
  const size_t num_planes = basis.size();
  blocks->plane_plane.assign(num_planes, Eigen::Matrix3d::Zero());
  blocks->plane_keyframes.resize(num_planes);
  blocks->plane_pose.resize(num_planes);
  ParallelFor(0, num_planes, [&](size_t j) {
    const size_t first = problem.plane_tile_begin[j];
    const size_t last = problem.plane_tile_begin[j + 1];
    std::vector<int>& keyframes = blocks->plane_keyframes[j];
    for (size_t t = first; t < last; ++t) {
      for (size_t s = problem.tiles[t].segment_begin;
           s < problem.tiles[t].segment_end; ++s) {
        keyframes.push_back(problem.segments[s].keyframe);
      }
    }
    std::sort(keyframes.begin(), keyframes.end());
    keyframes.erase(std::unique(keyframes.begin(), keyframes.end()),
                    keyframes.end());
    auto& pose_part = blocks->plane_pose[j];
    pose_part.setZero(3, 6 * static_cast<Eigen::Index>(keyframes.size()));
    for (size_t t = first; t < last; ++t) {
      const TexelTile& tile = problem.tiles[t];
      if (tile.segment_begin == tile.segment_end) continue;
      const Eigen::Matrix2d tensor = weight * pass.tensors[t].cast<double>();
      Eigen::Matrix<double, 2, 3> sum = Eigen::Matrix<double, 2, 3>::Zero();
      for (size_t s = tile.segment_begin; s < tile.segment_end; ++s) {
        sum += pass.views[s].share * pass.views[s].plane_shift.cast<double>() *
               basis[j];
      }
      blocks->plane_plane[j] -=
          common_share / share_sum[t] * sum.transpose() * tensor * sum;
      for (size_t s = tile.segment_begin; s < tile.segment_end; ++s) {
        const TileView& view = pass.views[s];
        const Eigen::Matrix<double, 2, 3> b =
            view.plane_shift.cast<double>() * basis[j];
        blocks->plane_plane[j] += view.share * b.transpose() * tensor * b;
        const auto where = std::lower_bound(keyframes.begin(), keyframes.end(),
                                            problem.segments[s].keyframe);
        pose_part.middleCols<6>(6 * (where - keyframes.begin())) +=
            view.share * (b - common_share / share_sum[t] * sum).transpose() *
            tensor * view.pose_shift.cast<double>();
      }
    }
  });
}

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
void SubtractPlanes(const JointSystem& system, int num_keyframes,
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

// Upper Cholesky factor of a symmetric matrix given by its upper triangle;
// raises the diagonal until it exists.
Eigen::MatrixXd UpperFactor(const Eigen::MatrixXd& upper) {
  Eigen::MatrixXd symmetric = upper.selfadjointView<Eigen::Upper>();
  for (double shift = kJointShift;; shift *= 10) {
    const Eigen::LLT<Eigen::MatrixXd, Eigen::Upper> llt(symmetric);
    if (llt.info() == Eigen::Success) return llt.matrixU();
    for (Eigen::Index i = 0; i < symmetric.rows(); ++i) {
      symmetric(i, i) += shift * std::abs(upper(i, i)) + kAbsoluteShift;
    }
  }
}

}  // namespace

JointSystem FactorJointSystem(const TextureProblem& problem,
                              const JointPass& pass,
                              const ReconState& state,
                              const std::vector<PlaneBasis>& plane_basis,
                              double weight,
                              double plane_weight,
                              double common_share) {
  const int num_keyframes = problem.NumKeyframes();
  std::vector<double> share_sum(problem.tiles.size(), 0.0);
  for (size_t t = 0; t < problem.tiles.size(); ++t) {
    for (size_t s = problem.tiles[t].segment_begin;
         s < problem.tiles[t].segment_end; ++s) {
      share_sum[t] += pass.views[s].share;
    }
  }
  Blocks blocks;
  blocks.pose_pose.setZero(6 * num_keyframes, 6 * num_keyframes);
  AddPoseRows(problem, pass, share_sum, weight, common_share,
              &blocks.pose_pose);
  ShiftDiagonal(&blocks.pose_pose);
  Eigen::VectorXd g(6 * num_keyframes);
  for (int k = 0; k < num_keyframes; ++k) {
    g.segment<6>(6 * k) = weight * pass.pose_gradient[k];
  }

  JointSystem system;
  AddPlaneBlocks(problem, pass, share_sum, plane_basis, weight, common_share,
                 &blocks);
  system.planes.resize(plane_basis.size());
  ParallelFor(0, plane_basis.size(), [&](size_t j) {
    JointPlaneRows& rows = system.planes[j];
    const Eigen::Matrix4d moment = plane_weight * problem.moments[j];
    const Eigen::Map<const Eigen::Vector4d> phi(state.planes.data() +
                                                kPlaneSize * j);
    blocks.plane_plane[j] +=
        plane_basis[j].transpose() * moment * plane_basis[j];
    const Eigen::Vector3d plane_gradient =
        plane_basis[j].transpose() *
        (weight * pass.plane_gradient[j] + moment * phi);
    ShiftDiagonal(&blocks.plane_plane[j]);
    rows.diagonal = UpperFactor(blocks.plane_plane[j]);
    const auto lower = rows.diagonal.transpose().triangularView<Eigen::Lower>();
    rows.keyframes = std::move(blocks.plane_keyframes[j]);
    rows.poses = lower.solve(blocks.plane_pose[j]);
    rows.residual = lower.solve(plane_gradient);
  });
  SubtractPlanes(system, num_keyframes, &blocks.pose_pose);
  for (const JointPlaneRows& rows : system.planes) {
    for (size_t a = 0; a < rows.keyframes.size(); ++a) {
      g.segment<6>(6 * rows.keyframes[a]) -=
          rows.poses.middleCols<6>(6 * a).transpose() * rows.residual;
    }
    system.explained += rows.residual.squaredNorm();
  }
  system.poses = UpperFactor(blocks.pose_pose);
  system.pose_residual =
      system.poses.transpose().triangularView<Eigen::Lower>().solve(g);
  system.explained += system.pose_residual.squaredNorm();
  return system;
}

}  // namespace facet
