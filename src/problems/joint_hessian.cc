// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "problems/joint_hessian.h"

#include <algorithm>
#include <utility>

#include "util/parallel_for.h"

namespace facet {
namespace {

// Keyframes that see the plane, ascending.
std::vector<int> KeyframesOfPlane(const TextureProblem& problem, int plane) {
  std::vector<int> keyframes;
  for (size_t t = problem.plane_tile_begin[plane];
       t < problem.plane_tile_begin[plane + 1];
       ++t) {
    for (size_t s = problem.tiles[t].segment_begin;
         s < problem.tiles[t].segment_end;
         ++s) {
      keyframes.push_back(problem.segments[s].keyframe);
    }
  }
  std::sort(keyframes.begin(), keyframes.end());
  keyframes.erase(std::unique(keyframes.begin(), keyframes.end()),
                  keyframes.end());
  return keyframes;
}

// For each keyframe the segments that belong to it, as (tile, segment).
std::vector<std::vector<std::pair<uint32_t, uint32_t>>> SegmentsByFrame(
    const TextureProblem& problem) {
  std::vector<std::vector<std::pair<uint32_t, uint32_t>>> by_frame(
      problem.NumKeyframes());
  for (size_t t = 0; t < problem.tiles.size(); ++t) {
    for (size_t s = problem.tiles[t].segment_begin;
         s < problem.tiles[t].segment_end;
         ++s) {
      by_frame[problem.segments[s].keyframe].push_back(
          {static_cast<uint32_t>(t), static_cast<uint32_t>(s)});
    }
  }
  return by_frame;
}

// block += scale * bt * b, in the order of memory.
void AddProduct(const Eigen::Matrix<float, 6, 2>& bt,
                const Eigen::Matrix<float, 2, 6>& b,
                float scale,
                Eigen::Matrix<double, 6, 6>* block) {
  double* sum = block->data();
  const float* left = bt.data();
  for (int column = 0; column < 6; ++column) {
    const float b0 = scale * b(0, column), b1 = scale * b(1, column);
    for (int i = 0; i < 6; ++i) {
      sum[6 * column + i] +=
          static_cast<double>(left[i] * b0 + left[6 + i] * b1);
    }
  }
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
  const size_t num_keyframes = by_frame.size();
  ParallelFor(0, num_keyframes, [&](size_t i) {
    // Blocks one after the other: the columns of h are far apart.
    std::vector<Eigen::Matrix<double, 6, 6>> row(
        num_keyframes - i, Eigen::Matrix<double, 6, 6>::Zero());
    for (const auto& [t, s] : by_frame[i]) {
      const TexelTile& tile = problem.tiles[t];
      const TileView& view = pass.views[s];
      const Eigen::Matrix<float, 6, 2> bt =
          view.pose_shift.transpose() *
          (weight * view.share * pass.tensors[t].Sum()).cast<float>();
      AddProduct(bt, view.pose_shift, 1.0f, &row[0]);
      const float scale = static_cast<float>(-common_share / share_sum[t]);
      for (size_t other = s; other < tile.segment_end; ++other) {
        const TileView& second = pass.views[other];
        AddProduct(bt,
                   second.pose_shift,
                   scale * second.share,
                   &row[problem.segments[other].keyframe - i]);
      }
    }
    for (size_t k = i; k < num_keyframes; ++k) {
      h->block<6, 6>(6 * i, 6 * k) += row[k - i];
    }
  });
}

// Plane blocks, by plane. The plane's part of a view's row at a texel is
// (v_i^T g) m^T of the tangent axes, m = (u1, u2, 1).
void AddPlaneBlocks(const TextureProblem& problem,
                    const JointPass& pass,
                    const std::vector<double>& share_sum,
                    const std::vector<PlaneBasis>& basis,
                    double weight,
                    double common_share,
                    std::vector<JointPlaneBlocks>* planes) {
  ParallelFor(0, basis.size(), [&](size_t j) {
    JointPlaneBlocks& plane = (*planes)[j];
    const Eigen::Matrix3d axes = basis[j].transpose() * pass.plane_axes[j];
    Eigen::Matrix3d sum_mm = Eigen::Matrix3d::Zero();
    for (size_t t = problem.plane_tile_begin[j];
         t < problem.plane_tile_begin[j + 1];
         ++t) {
      const TexelTile& tile = problem.tiles[t];
      if (tile.segment_begin == tile.segment_end) continue;
      const TileTensor& tensor = pass.tensors[t];
      Eigen::Vector2d sum = Eigen::Vector2d::Zero();
      for (size_t s = tile.segment_begin; s < tile.segment_end; ++s) {
        const TileView& view = pass.views[s];
        sum += view.share * view.plane_shift.cast<double>();
      }
      sum_mm -= common_share / share_sum[t] * tensor.Between(sum, sum);
      for (size_t s = tile.segment_begin; s < tile.segment_end; ++s) {
        const TileView& view = pass.views[s];
        const Eigen::Vector2d v = view.plane_shift.cast<double>();
        sum_mm += view.share * tensor.Between(v, v);
        const Eigen::Vector2d left = v - common_share / share_sum[t] * sum;
        Eigen::Matrix<double, 3, 2> m;  // sum_p m (left^T T)
        m.col(0) = left.x() * tensor.s11.col(2) + left.y() * tensor.s12.col(2);
        m.col(1) = left.x() * tensor.s12.col(2) + left.y() * tensor.s22.col(2);
        const auto where = std::lower_bound(plane.keyframes.begin(),
                                            plane.keyframes.end(),
                                            problem.segments[s].keyframe);
        plane.poses.middleCols<6>(6 * (where - plane.keyframes.begin())) +=
            weight * view.share * (axes * m) * view.pose_shift.cast<double>();
      }
    }
    plane.plane = weight * axes * sum_mm * axes.transpose();
  });
}

}  // namespace

JointHessian ZeroJointHessian(const TextureProblem& problem,
                              size_t num_planes) {
  JointHessian zero;
  zero.poses.resize(6 * problem.NumKeyframes(), 6 * problem.NumKeyframes());
  ParallelFor(0, zero.poses.cols(), [&](size_t i) {
    zero.poses.col(static_cast<Eigen::Index>(i)).setZero();
  });
  zero.planes.resize(num_planes);
  ParallelFor(0, num_planes, [&](size_t j) {
    zero.planes[j].keyframes = KeyframesOfPlane(problem, static_cast<int>(j));
    zero.planes[j].poses.setZero(
        3, 6 * static_cast<Eigen::Index>(zero.planes[j].keyframes.size()));
  });
  return zero;
}

JointHessian TensorHessian(const TextureProblem& problem,
                           const JointPass& pass,
                           const std::vector<PlaneBasis>& plane_basis,
                           double weight,
                           double common_share) {
  std::vector<double> share_sum(problem.tiles.size(), 0.0);
  for (size_t t = 0; t < problem.tiles.size(); ++t) {
    for (size_t s = problem.tiles[t].segment_begin;
         s < problem.tiles[t].segment_end;
         ++s) {
      share_sum[t] += pass.views[s].share;
    }
  }
  JointHessian hessian = ZeroJointHessian(problem, plane_basis.size());
  AddPoseRows(problem, pass, share_sum, weight, common_share, &hessian.poses);
  AddPlaneBlocks(problem,
                 pass,
                 share_sum,
                 plane_basis,
                 weight,
                 common_share,
                 &hessian.planes);
  return hessian;
}

}  // namespace facet
