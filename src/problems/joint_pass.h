// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// One pass over all observations for the joint solve of poses, planes and
// colours: cost and exact gradient with the colours re-averaged, and what the
// Hessian needs.
//
// With C = mean (variable projection) the cost is sum (I_i - mean)^2 and its
// gradient sum (I_i - mean) dI_i, exactly. (With a robust loss: sum rho and sum
// rho' (I_i - mean) dI_i about the weighted mean, and views weighted likewise;
// with three channels, their mean.) The Gauss-Newton Hessian of a tile is
// built from a consensus tensor: all views see the same texture, so the mean
// texture gradient gbar(p) stands for every view's own, noisy one:
//
//   T(p) = (1 - eta) gbar gbar^T + eta mean_i(g_i g_i^T)    2 x 2
//   H    = sum_p [ sum_i c_i B_i^T T B_i
//                  - kappa / sum(c) (sum c_i B_i)^T T (sum c_i B_i) ]
//
// where B_i maps increments of pose i and of the plane to the shift of the
// texture under that view [m], and c_i is the share of the tile's texels that
// keyframe i sees. Motions common to all views cost nothing, as in the true
// energy (kappa slightly below 1 keeps H definite). The share eta of the views'
// own tensors keeps H up where misaligned views average the texture away.
//
// On a tile the pose part of B_i is taken as constant, that of its centre, and
// so is the direction v_i of the shift that a plane displacement causes. The
// displacement itself is linear in the texel's place (u1, u2) about the anchor:
// the tilt of a plane no larger than a tile would otherwise have no curvature
// at all. So sums over texels of T(p) (u1, u2, 1)^T (u1, u2, 1) are what H
// needs of a tile, and it is positive semi-definite texel by texel.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "geometry/pose.h"
#include "problems/texture_problem.h"

namespace facet {

// How a view of a tile shifts its texture; one for each TileSegment.
struct TileView {
  float share = 0;                        // c_i in (0, 1]
  Eigen::Matrix<float, 2, 6> pose_shift;  // d shift / d xi_i (left)
  Eigen::Vector2f plane_shift;            // v_i: per metre along -normal
};

// sum_p T_ab(p) m m^T with m = (u1, u2, 1), for ab = 11, 12, 22.
struct TileTensor {
  Eigen::Matrix3d s11, s12, s22;

  // sum_p T.
  Eigen::Matrix2d Sum() const;
  // sum_p (v^T T w) m m^T.
  Eigen::Matrix3d Between(const Eigen::Vector2d& v,
                          const Eigen::Vector2d& w) const;
};

struct JointPass {
  double squares = 0;                 // sum of (I - mean)^2, or of its rho
  std::vector<double> plane_squares;  // the same by plane
  PhotoCounts counts;
  // With derivatives: half the gradient of `squares`.
  std::vector<Vector6d> pose_gradient;          // by keyframe, left tangent
  std::vector<Eigen::Vector4d> plane_gradient;  // by plane, ambient (n, d)
  std::vector<TileView> views;                  // by segment
  std::vector<TileTensor> tensors;              // by tile
  // Of each plane: (u1, u2, 1) -> increment of (n, d), 4 x 3; a displacement
  // is m^T of its transpose. An orthonormal basis of the tangent of |n| = 1.
  std::vector<Eigen::Matrix<double, 4, 3>> plane_axes;
};

// `own_share` is eta in [0, 1].
JointPass RunJointPass(const TextureProblem& problem,
                       const ReconState& state,
                       bool with_derivatives,
                       double own_share);

}  // namespace facet
