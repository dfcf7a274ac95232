// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>

#include "costs/plane_manifold.h"
#include "problems/joint_hessian.h"
#include "problems/joint_rows.h"
#include "problems/tile_samples.h"
#include "util/parallel_for.h"

namespace facet {
namespace {

// Everything an observation needs, at one state.
struct ExactScene {
  const TextureProblem& problem;
  const ReconState& state;
  std::vector<PhotoChannel> channels;
  std::vector<FramePose> poses;
};

// Derivatives of an observation's intensity: rows of the pose and of (n, d).
struct PhotoRows {
  Vector6d pose;
  Eigen::Vector4d plane;
};

PhotoRows RowsOf(const ExactScene& scene,
                 const TexelTile& tile,
                 const PlaneFrame& frame,
                 const FramePose& pose,
                 size_t texel,
                 double g1,
                 double g2) {
  const TextureProblem& problem = scene.problem;
  const PhotoTexel& point = scene.channels[0].points[texel];
  const Eigen::Vector3d q(point.x, point.y, point.z);
  const double gn = frame.AlongNormal(g1, g2, q - pose.center);
  const Eigen::Vector3d g = g1 * frame.e1 + g2 * frame.e2 + gn * frame.n;
  const Eigen::Vector3d g_in_cam = pose.r * g;
  const Eigen::Vector3d p = problem.texels.position[texel].cast<double>();
  PhotoRows rows;
  rows.pose << (pose.r * q + pose.t).cross(g_in_cam), g_in_cam;
  rows.plane << -gn * (p - problem.anchors[tile.plane]) -
                    frame.n.dot(p - problem.origin - q) * g,
      -gn;
  return rows;
}

// Sum of the weights of each texel's samples.
std::vector<double> WeightSums(const TextureProblem& problem,
                               const TexelTile& tile,
                               const TileSamples& samples) {
  std::vector<double> sums(tile.texel_end - tile.texel_begin, 0.0);
  ForEachSample(problem, tile, samples, [&](size_t, size_t texel, size_t i) {
    sums[texel] += samples.weight ? samples.weight[i] : 1.0;
  });
  return sums;
}

// Adds one channel. Columns: 6 a segment of the tile, then the 4 ambient ones
// of the plane. Upper triangle.
void AddSamples(const ExactScene& scene,
                const TexelTile& tile,
                const PlaneFrame& frame,
                const TileSamples& samples,
                double channel_weight,
                Eigen::MatrixXd* h) {
  const TextureProblem& problem = scene.problem;
  const Eigen::Index at_plane = h->rows() - 4;
  const std::vector<double> weight_sums = WeightSums(problem, tile, samples);
  // sum_i w_i J_i / sqrt(sum w), a column a texel.
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(
      h->rows(), static_cast<Eigen::Index>(weight_sums.size()));
  ForEachSample(problem, tile, samples, [&](size_t s, size_t texel, size_t i) {
    const double weight = samples.weight ? samples.weight[i] : 1.0;
    if (weight == 0) return;
    const PhotoRows rows = RowsOf(scene,
                                  tile,
                                  frame,
                                  scene.poses[problem.segments[s].keyframe],
                                  tile.texel_begin + texel,
                                  samples.g1[i],
                                  samples.g2[i]);
    const Eigen::Index at =
        6 * static_cast<Eigen::Index>(s - tile.segment_begin);
    const double w = channel_weight * weight;
    h->block<6, 6>(at, at).noalias() += w * rows.pose * rows.pose.transpose();
    h->block<6, 4>(at, at_plane).noalias() +=
        w * rows.pose * rows.plane.transpose();
    h->block<4, 4>(at_plane, at_plane).noalias() +=
        w * rows.plane * rows.plane.transpose();
    const double scale = weight / std::sqrt(weight_sums[texel]);
    const Eigen::Index column = static_cast<Eigen::Index>(texel);
    sums.block<6, 1>(at, column) += scale * rows.pose;
    sums.block<4, 1>(at_plane, column) += scale * rows.plane;
  });
  h->selfadjointView<Eigen::Upper>().rankUpdate(sums, -channel_weight);
}

Eigen::MatrixXd TileHessian(const ExactScene& scene, size_t t, TileSlab* slab) {
  const TextureProblem& problem = scene.problem;
  const TexelTile& tile = problem.tiles[t];
  const PlaneFrame frame(scene.state.planes.data() + kPlaneSize * tile.plane);
  const Eigen::Index size =
      6 * static_cast<Eigen::Index>(tile.segment_end - tile.segment_begin) + 4;
  Eigen::MatrixXd h = Eigen::MatrixXd::Zero(size, size);
  for (size_t c = 0; c < scene.channels.size(); ++c) {
    AddSamples(
        scene, tile, frame, slab->Of(t, c), 1.0 / problem.NumChannels(), &h);
  }
  return h;
}

void AddTile(const TextureProblem& problem,
             const TexelTile& tile,
             const Eigen::MatrixXd& h,
             const std::vector<PlaneBasis>& plane_basis,
             double weight,
             JointHessian* sum) {
  const Eigen::Index at_plane = h.rows() - 4;
  const auto keyframe = [&](Eigen::Index s) {
    return problem.segments[tile.segment_begin + static_cast<size_t>(s)]
        .keyframe;
  };
  for (Eigen::Index a = 0; 6 * a < at_plane; ++a) {
    for (Eigen::Index b = a; 6 * b < at_plane; ++b) {
      sum->poses.block<6, 6>(6 * keyframe(a), 6 * keyframe(b)) +=
          weight * h.block<6, 6>(6 * a, 6 * b);
    }
  }
  if (plane_basis.empty()) return;
  const PlaneBasis& basis = plane_basis[tile.plane];
  JointPlaneBlocks& blocks = sum->planes[tile.plane];
  const Eigen::Matrix4d plane =
      h.bottomRightCorner<4, 4>().selfadjointView<Eigen::Upper>();
  blocks.plane += weight * basis.transpose() * plane * basis;
  for (Eigen::Index a = 0; 6 * a < at_plane; ++a) {
    const auto where = std::lower_bound(
        blocks.keyframes.begin(), blocks.keyframes.end(), keyframe(a));
    blocks.poses.middleCols<6>(6 * (where - blocks.keyframes.begin())) +=
        weight * basis.transpose() * h.block<6, 4>(6 * a, at_plane).transpose();
  }
}

}  // namespace

JointHessian ExactHessian(const TextureProblem& problem,
                          const ReconState& state,
                          const std::vector<PlaneBasis>& plane_basis,
                          double weight) {
  const ExactScene scene = {problem,
                            state,
                            MakePhotoChannels(problem, state, PointsAt::kPlane),
                            MakeFramePoses(problem, state)};
  const std::vector<PlaneAxes> axes = AxesOfPlanes(problem, state);
  TileSlab slab(problem, scene.channels, axes);
  JointHessian sum = ZeroJointHessian(problem, plane_basis.size());
  // Tiles are added up in order; a batch at a time bounds the memory.
  constexpr size_t kBatch = 64;
  std::vector<Eigen::MatrixXd> batch(kBatch);
  for (size_t begin = 0; begin < problem.tiles.size(); begin += kBatch) {
    const size_t end = std::min(begin + kBatch, problem.tiles.size());
    slab.Sample(begin, end);
    ParallelFor(begin, end, [&](size_t t) {
      batch[t - begin] = TileHessian(scene, t, &slab);
    });
    for (size_t t = begin; t < end; ++t) {
      AddTile(problem,
              problem.tiles[t],
              batch[t - begin],
              plane_basis,
              weight,
              &sum);
    }
  }
  return sum;
}

}  // namespace facet
