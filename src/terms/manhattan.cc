// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "terms/manhattan.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <cmath>
#include <memory>

#include "costs/axis_plane.h"
#include "costs/plane_manifold.h"

namespace facet {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;
constexpr double kIntensity = 0.05;  // of a residual that weighs 1

Eigen::Vector3d NormalOf(const TermInput& input, int plane) {
  return Eigen::Map<const Eigen::Vector3d>(input.start.planes.data() +
                                           kPlaneSize * plane)
      .normalized();
}

double TexelsOf(const TermInput& input, int plane) {
  return static_cast<double>(input.problem.plane_texels[plane]);
}

// The normal of the largest plane that is nearly perpendicular to `across`; of
// all planes if that is zero.
Eigen::Vector3d LargestNormal(const TermInput& input,
                              const Eigen::Vector3d& across) {
  Eigen::Vector3d best = across.isZero()
                             ? Eigen::Vector3d(Eigen::Vector3d::UnitZ())
                             : across.unitOrthogonal();
  double most = 0;
  for (int j = 0; j < input.problem.NumPlanes(); ++j) {
    const Eigen::Vector3d n = NormalOf(input, j);
    if (TexelsOf(input, j) <= most) continue;
    if (std::abs(n.dot(across)) > std::sin(10 * kDegree)) continue;
    most = TexelsOf(input, j);
    best = n;
  }
  return best;
}

// Index of the axis within `degrees` of the normal, else -1; the sign with it.
int AxisOf(const Eigen::Matrix3d& axes,
           const Eigen::Vector3d& normal,
           double degrees,
           double* sign) {
  int best = 0;
  const Eigen::Vector3d cosines = axes.transpose() * normal;
  const double cosine = cosines.cwiseAbs().maxCoeff(&best);
  *sign = cosines[best] < 0 ? -1 : 1;
  return cosine >= std::cos(degrees * kDegree) ? best : -1;
}

}  // namespace

Eigen::Matrix3d EstimateAxes(const TermInput& input) {
  Eigen::Matrix3d axes;
  axes.col(0) = LargestNormal(input, Eigen::Vector3d::Zero());
  axes.col(1) = LargestNormal(input, axes.col(0));
  axes.col(1) -= axes.col(0).dot(axes.col(1)) * axes.col(0);
  axes.col(1).normalize();
  axes.col(2) = axes.col(0).cross(axes.col(1));
  for (int round = 0; round < 10; ++round) {
    // The rotation nearest to the mean normals (orthogonal Procrustes).
    Eigen::Matrix3d sums = 1e-9 * axes;
    for (int j = 0; j < input.problem.NumPlanes(); ++j) {
      double sign = 1;
      const Eigen::Vector3d n = NormalOf(input, j);
      const int a = AxisOf(axes, n, 10, &sign);
      if (a >= 0) sums.col(a) += sign * TexelsOf(input, j) * n;
    }
    const Eigen::JacobiSVD<Eigen::Matrix3d> svd(
        sums, Eigen::ComputeFullU | Eigen::ComputeFullV);
    axes = svd.matrixU() * svd.matrixV().transpose();
  }
  return axes;
}

Term MakeManhattanTerm(const TermInput& input, double weight) {
  Term term;
  const Eigen::Matrix3d axes = EstimateAxes(input);
  const double per_texel =
      weight * input.texel_weight * std::pow(kIntensity / kDegree, 2);
  for (int j = 0; j < input.problem.NumPlanes(); ++j) {
    double sign = 1;
    const int a = AxisOf(axes, NormalOf(input, j), 5, &sign);
    if (a < 0 || TexelsOf(input, j) == 0) continue;
    TermBlock block;
    block.cost = std::shared_ptr<const ceres::CostFunction>(
        AxisPlaneCost::Create(axes.col(a), per_texel * TexelsOf(input, j)));
    block.plane = j;
    term.blocks.push_back(block);
  }
  return term;
}

}  // namespace facet
