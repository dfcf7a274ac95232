// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "problems/joint_pass.h"

#include <algorithm>
#include <cmath>

#include "costs/plane_manifold.h"
#include "problems/joint_rows.h"
#include "problems/tile_samples.h"
#include "util/parallel_for.h"

namespace facet {
namespace {

struct SegmentGradient {
  Vector6d pose = Vector6d::Zero();
  Eigen::Vector4d plane = Eigen::Vector4d::Zero();
};

// B_i at the point q: the point seen along the ray moves on the plane by
// E^T (I - d n^T / (n.d)) dq, d the viewing direction.
TileView ViewAt(const Eigen::Vector3d& q,
                const PlaneFrame& frame,
                const FramePose& pose) {
  const Eigen::Vector3d y = pose.r * q + pose.t;
  const Eigen::Vector3d d = (q - pose.center).normalized();
  double cosine = frame.n.dot(d);
  // A grazing view says nothing about the shift; keep the map bounded.
  if (std::abs(cosine) < 0.1) cosine = cosine < 0 ? -0.1 : 0.1;
  Eigen::Matrix<double, 2, 3> axes;
  axes << frame.e1.transpose(), frame.e2.transpose();
  const Eigen::Matrix<double, 2, 3> along_ray =
      axes - axes * d * frame.n.transpose() / cosine;
  Eigen::Matrix<double, 3, 6> dy;
  dy << -Skew(y), Eigen::Matrix3d::Identity();
  TileView view;
  view.pose_shift = (along_ray * pose.r.transpose() * dy).cast<float>();
  // dq = -n ds; E^T n = 0.
  view.plane_shift = (axes * d / cosine).cast<float>();
  return view;
}

// Sums of gradients over the views of a texel, with a robust loss weighted with
// rho'.
struct TexelGradients {
  float g1 = 0, g2 = 0, g11 = 0, g12 = 0, g22 = 0, views = 0;
};

// Adds `weight` times T(p) of every texel as (11, 12, 22), from the mean
// gradient and the views' own ones.
void AddTexelTensors(const TextureProblem& problem,
                     const TexelTile& tile,
                     const TileSamples& samples,
                     double own_share,
                     double weight,
                     std::vector<Eigen::Vector3d>* tensors) {
  std::vector<TexelGradients> texels(tile.texel_end - tile.texel_begin);
  const float* weights = samples.weight;
  ForEachSample(problem, tile, samples, [&](size_t, size_t texel, size_t i) {
    const float w = weights ? weights[i] : 1.0f;
    if (w == 0) return;
    TexelGradients& t = texels[texel];
    const float g1 = samples.g1[i], g2 = samples.g2[i];
    const float wg1 = w * g1, wg2 = w * g2;
    t.g1 += wg1;
    t.g2 += wg2;
    t.g11 += wg1 * g1;
    t.g12 += wg1 * g2;
    t.g22 += wg2 * g2;
    t.views += w;
  });
  for (size_t i = 0; i < texels.size(); ++i) {
    const TexelGradients& t = texels[i];
    if (t.views == 0) continue;
    const double n = t.views, g1 = t.g1 / n, g2 = t.g2 / n;
    (*tensors)[i] +=
        weight * (own_share / n * Eigen::Vector3d(t.g11, t.g12, t.g22) +
                  (1 - own_share) * Eigen::Vector3d(g1 * g1, g1 * g2, g2 * g2));
  }
}

TileTensor SumTensors(const TextureProblem& problem,
                      const std::vector<PhotoTexel>& points,
                      const TexelTile& tile,
                      const PlaneFrame& frame,
                      const std::vector<Eigen::Vector3d>& tensors) {
  const Eigen::Vector3d anchor = problem.anchors[tile.plane] - problem.origin;
  TileTensor sum;
  sum.s11.setZero();
  sum.s12.setZero();
  sum.s22.setZero();
  for (size_t i = 0; i < tensors.size(); ++i) {
    const PhotoTexel& point = points[tile.texel_begin + i];
    const Eigen::Vector3d arm =
        Eigen::Vector3d(point.x, point.y, point.z) - anchor;
    const Eigen::Vector3d m(frame.e1.dot(arm), frame.e2.dot(arm), 1.0);
    const Eigen::Matrix3d mm = m * m.transpose();
    sum.s11 += tensors[i][0] * mm;
    sum.s12 += tensors[i][1] * mm;
    sum.s22 += tensors[i][2] * mm;
  }
  return sum;
}

// A tile as the kernel sees it: texels about its centre in the plane's axes.
struct Patch {
  Eigen::Vector3d center, anchor;
  std::vector<PhotoPatchTexel> texels;  // colours not set
};

Eigen::Vector3d TileCenter(const TexelTile& tile,
                           const std::vector<PhotoTexel>& points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (size_t i = tile.texel_begin; i < tile.texel_end; ++i) {
    sum += Eigen::Vector3d(points[i].x, points[i].y, points[i].z);
  }
  return sum / static_cast<double>(tile.texel_end - tile.texel_begin);
}

Patch MakePatch(const TextureProblem& problem,
                const TexelTile& tile,
                const std::vector<PhotoTexel>& points,
                const PlaneFrame& frame) {
  Patch patch;
  patch.center = TileCenter(tile, points);
  patch.anchor = problem.anchors[tile.plane] - problem.origin;
  patch.texels.resize(tile.texel_end - tile.texel_begin);
  for (size_t i = 0; i < patch.texels.size(); ++i) {
    const size_t id = tile.texel_begin + i;
    const Eigen::Vector3d q(points[id].x, points[id].y, points[id].z);
    const Eigen::Vector3d arm = q - patch.center;
    const Eigen::Vector3d p =
        problem.texels.position[id].cast<double>() - problem.origin;
    patch.texels[i].e1 = static_cast<float>(frame.e1.dot(arm));
    patch.texels[i].e2 = static_cast<float>(frame.e2.dot(arm));
    patch.texels[i].s = static_cast<float>(frame.n.dot(p - q));
  }
  return patch;
}

// Exact gradient of one view of a tile, from sums over its samples:
// q = center + a e1 + b e2, p - q = s n, and G as in problems/joint_rows.h.
SegmentGradient GradientOf(const PhotoViewSums& sums,
                           const Patch& patch,
                           const PlaneFrame& frame,
                           const FramePose& pose) {
  const Eigen::Vector3d force =
      sums.g1 * frame.e1 + sums.g2 * frame.e2 + sums.gn * frame.n;
  const Eigen::Vector3d moment = patch.center.cross(force) +
                                 (sums.e1_g2 - sums.e2_g1) * frame.n -
                                 sums.e1_gn * frame.e2 + sums.e2_gn * frame.e1;
  const Eigen::Vector3d force_in_cam = pose.r * force;
  SegmentGradient gradient;
  gradient.pose << pose.r * moment + pose.t.cross(force_in_cam), force_in_cam;
  gradient.plane.head<3>() =
      -(sums.gn * (patch.center - patch.anchor) + sums.e1_gn * frame.e1 +
        sums.e2_gn * frame.e2 + 2 * sums.s_gn * frame.n + sums.s_g1 * frame.e1 +
        sums.s_g2 * frame.e2);
  gradient.plane[3] = -sums.gn;
  return gradient;
}

// Sum of the weights of one view's samples.
double WeightOf(const TileSegment& segment,
                const TileSamples& samples,
                size_t offset) {
  const size_t n = segment.end - segment.begin;
  if (!samples.weight) return static_cast<double>(n);
  double sum = 0;
  for (size_t i = 0; i < n; ++i) sum += samples.weight[offset + i];
  return sum;
}

size_t TexelsSeen(const TextureProblem& problem, const TexelTile& tile) {
  size_t seen = 0;
  for (size_t i = tile.texel_begin; i < tile.texel_end; ++i) {
    seen += problem.views[i] > 0 ? 1 : 0;
  }
  return seen;
}

// The pass over the tiles, each writing to places of its own.
class TileWorker {
 public:
  TileWorker(const TextureProblem& problem,
             const ReconState& state,
             double own_share,
             JointPass* pass)
      : problem_(problem),
        state_(state),
        channels_(MakePhotoChannels(problem, state, PointsAt::kPlane)),
        points_(channels_[0].points),
        channel_weight_(1.0 / problem.NumChannels()),
        poses_(MakeFramePoses(problem, state)),
        own_share_(own_share),
        pass_(pass),
        squares_(problem.tiles.size(), 0.0) {}

  void FindCosts() {
    pass_->counts = ForEachTile(
        problem_,
        channels_,
        {},
        [this](size_t t, const std::vector<TileSamples>* samples) {
          for (const TileSamples& channel : *samples) {
            squares_[t] += channel_weight_ * SumLoss(problem_,
                                                     problem_.tiles[t],
                                                     channel,
                                                     channel.mean.data());
          }
        });
    SumCosts();
  }

  void FindDerivatives() {
    for (int j = 0; j < problem_.NumPlanes(); ++j) {
      const PlaneFrame frame = FrameOf(j);
      pass_->plane_axes.push_back(Eigen::Matrix<double, 4, 3>::Zero());
      pass_->plane_axes.back().col(0).head<3>() = frame.e1;
      pass_->plane_axes.back().col(1).head<3>() = frame.e2;
      pass_->plane_axes.back()(3, 2) = 1;
    }
    pass_->views.resize(problem_.segments.size());
    pass_->tensors.resize(problem_.tiles.size());
    gradients_.resize(problem_.segments.size());
    pass_->counts =
        ForEachTile(problem_,
                    channels_,
                    AxesOfPlanes(problem_, state_),
                    [this](size_t t, const std::vector<TileSamples>* samples) {
                      PassTile(t, *samples);
                    });
    SumCosts();
    SumGradients();
  }

 private:
  PlaneFrame FrameOf(int plane) const {
    return PlaneFrame(state_.planes.data() + kPlaneSize * plane);
  }

  void PassTile(size_t t, const std::vector<TileSamples>& by_channel) {
    const TexelTile& tile = problem_.tiles[t];
    const PlaneFrame frame = FrameOf(tile.plane);
    Patch patch = MakePatch(problem_, tile, points_, frame);
    for (size_t s = tile.segment_begin; s < tile.segment_end; ++s) {
      pass_->views[s] =
          ViewAt(patch.center, frame, poses_[problem_.segments[s].keyframe]);
    }
    const double seen = static_cast<double>(TexelsSeen(problem_, tile));
    std::vector<Eigen::Vector3d> tensors(patch.texels.size(),
                                         Eigen::Vector3d::Zero());
    for (const TileSamples& samples : by_channel) {
      AddTexelTensors(
          problem_, tile, samples, own_share_, channel_weight_, &tensors);
      for (size_t i = 0; i < patch.texels.size(); ++i) {
        patch.texels[i].color = samples.mean[i];
      }
      double squares = 0;
      for (size_t s = tile.segment_begin; s < tile.segment_end; ++s) {
        squares += PassView(tile, s, seen, samples, patch, frame);
      }
      if (samples.weight) {
        squares = SumLoss(problem_, tile, samples, samples.mean.data());
      }
      squares_[t] += channel_weight_ * squares;
    }
    if (tile.segment_begin == tile.segment_end) return;
    pass_->tensors[t] = SumTensors(problem_, points_, tile, frame, tensors);
    for (size_t s = tile.segment_begin; s < tile.segment_end; ++s) {
      // All dropped or outliers: keeps the sum of shares above 0.
      pass_->views[s].share = std::max(pass_->views[s].share, 1e-6f);
    }
  }

  // Share and gradient of one view. Returns its sum of squares.
  double PassView(const TexelTile& tile,
                  size_t s,
                  double seen,
                  const TileSamples& samples,
                  const Patch& patch,
                  const PlaneFrame& frame) {
    const TileSegment& segment = problem_.segments[s];
    const size_t offset = samples.offset[s - tile.segment_begin];
    pass_->views[s].share += static_cast<float>(
        channel_weight_ * WeightOf(segment, samples, offset) / seen);
    const FramePose& pose = poses_[segment.keyframe];
    const Eigen::Vector3d d = patch.center - pose.center;
    const float ray[3] = {static_cast<float>(frame.e1.dot(d)),
                          static_cast<float>(frame.e2.dot(d)),
                          static_cast<float>(frame.n.dot(d))};
    PhotoViewSums sums;
    GetPhotoKernel().view_sums(
        samples.intensity + offset,
        samples.g1 + offset,
        samples.g2 + offset,
        samples.weight ? samples.weight + offset : nullptr,
        patch.texels.data(),
        problem_.observations.texel.data() + segment.begin,
        static_cast<uint32_t>(tile.texel_begin),
        segment.end - segment.begin,
        ray,
        &sums);
    const SegmentGradient gradient = GradientOf(sums, patch, frame, pose);
    gradients_[s].pose += channel_weight_ * gradient.pose;
    gradients_[s].plane += channel_weight_ * gradient.plane;
    return sums.squares;
  }

  void SumCosts() {
    pass_->plane_squares.assign(problem_.NumPlanes(), 0.0);
    for (size_t t = 0; t < squares_.size(); ++t) {
      pass_->squares += squares_[t];
      pass_->plane_squares[problem_.tiles[t].plane] += squares_[t];
    }
  }

  void SumGradients() {
    pass_->pose_gradient.assign(poses_.size(), Vector6d::Zero());
    pass_->plane_gradient.assign(problem_.NumPlanes(), Eigen::Vector4d::Zero());
    for (const TexelTile& tile : problem_.tiles) {
      for (size_t s = tile.segment_begin; s < tile.segment_end; ++s) {
        pass_->pose_gradient[problem_.segments[s].keyframe] +=
            gradients_[s].pose;
        pass_->plane_gradient[tile.plane] += gradients_[s].plane;
      }
    }
  }

  const TextureProblem& problem_;
  const ReconState& state_;
  const std::vector<PhotoChannel> channels_;
  const std::vector<PhotoTexel>& points_;
  const double channel_weight_;
  const std::vector<FramePose> poses_;
  const double own_share_;
  JointPass* pass_;
  std::vector<double> squares_;  // by tile
  std::vector<SegmentGradient> gradients_;
};

}  // namespace

Eigen::Matrix2d TileTensor::Sum() const {
  Eigen::Matrix2d sum;
  sum << s11(2, 2), s12(2, 2), s12(2, 2), s22(2, 2);
  return sum;
}

Eigen::Matrix3d TileTensor::Between(const Eigen::Vector2d& v,
                                    const Eigen::Vector2d& w) const {
  return v.x() * w.x() * s11 + (v.x() * w.y() + v.y() * w.x()) * s12 +
         v.y() * w.y() * s22;
}

std::vector<FramePose> MakeFramePoses(const TextureProblem& problem,
                                      const ReconState& state) {
  std::vector<FramePose> poses(problem.NumKeyframes());
  for (size_t k = 0; k < poses.size(); ++k) {
    const Pose pose = state.CamFromWorld(static_cast<int>(k));
    poses[k].r = pose.RotationMatrix();
    poses[k].t = pose * problem.origin;
    poses[k].center = -poses[k].r.transpose() * poses[k].t;
  }
  return poses;
}

std::vector<PlaneAxes> AxesOfPlanes(const TextureProblem& problem,
                                    const ReconState& state) {
  std::vector<PlaneAxes> axes;
  for (int j = 0; j < problem.NumPlanes(); ++j) {
    const PlaneFrame frame(state.planes.data() + kPlaneSize * j);
    axes.push_back({frame.e1.cast<float>(), frame.e2.cast<float>()});
  }
  return axes;
}

JointPass RunJointPass(const TextureProblem& problem,
                       const ReconState& state,
                       bool with_derivatives,
                       double own_share) {
  JointPass pass;
  TileWorker worker(problem, state, own_share, &pass);
  if (with_derivatives) {
    worker.FindDerivatives();
  } else {
    worker.FindCosts();
  }
  return pass;
}

}  // namespace facet
