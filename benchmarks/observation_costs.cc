// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "benchmarks/observation_costs.h"

#include <algorithm>
#include <utility>

namespace facet {
namespace {

constexpr int kColumns = 14;

// Lifts a row over the left increment (omega, upsilon) to the seven numbers of
// the pose block, J P = J_xi with P as in costs/se3_manifold.h, without its
// pseudo-inverse: t depends on omega through omega x t, and dq/domega = M / 2
// with M' M = I.
void LiftRow(const double* row, const double* pose, double* lifted) {
  const Eigen::Map<const Eigen::Vector3d> omega(row), upsilon(row + 3);
  const Eigen::Map<const Eigen::Vector3d> v(pose), t(pose + 4);
  const double w = pose[3];
  const Eigen::Vector3d c = omega - t.cross(upsilon);
  Eigen::Map<Eigen::Vector3d> by_v(lifted), by_t(lifted + 4);
  by_v = 2 * (w * c - v.cross(c));
  lifted[3] = -2 * v.dot(c);
  by_t = upsilon;
}

// Writes 14 tangent columns as row `index` of the ambient Jacobians.
void StoreRow(const double* row,
              const double* pose,
              size_t index,
              double** jacobians) {
  if (jacobians[0]) LiftRow(row, pose, jacobians[0] + kPoseSize * index);
  for (int k = 0; k < 4; ++k) {
    if (jacobians[1 + k]) {
      std::copy(row + 6 + 2 * k, row + 8 + 2 * k, jacobians[1 + k] + 2 * index);
    }
  }
}

}  // namespace

double EvaluateObservation(const CellView& view,
                           const Eigen::Matrix3d& rotation,
                           const Eigen::Vector3d& translation,
                           double const* const* vertices,
                           const ObservedPoint& point,
                           double* row) {
  const Eigen::Vector3d y = rotation * point.q + translation;
  const Eigen::Vector2d u = view.camera.Project<double>(y);
  const double cell_x = 1 / view.lattice.CellWidth();
  const double cell_y = 1 / view.lattice.CellHeight();
  const double al = u.x() * cell_x - view.a, be = u.y() * cell_y - view.b;
  using Vertex = Eigen::Map<const Eigen::Vector2d>;
  const Vertex f00(vertices[0]), f10(vertices[1]);
  const Vertex f01(vertices[2]), f11(vertices[3]);
  const double w[4] = {
      (1 - al) * (1 - be), al * (1 - be), (1 - al) * be, al * be};
  const Eigen::Vector2d warped =
      u + w[0] * f00 + w[1] * f10 + w[2] * f01 + w[3] * f11;
  const Sample sample = SampleAt(view.image, warped.x(), warped.y());
  if (row) {
    const Eigen::Vector2d gradient(sample.dx, sample.dy);
    const Eigen::Vector2d along_x =
        cell_x * ((1 - be) * (f10 - f00) + be * (f11 - f01));
    const Eigen::Vector2d along_y =
        cell_y * ((1 - al) * (f01 - f00) + al * (f11 - f10));
    const double gx = (sample.dx + gradient.dot(along_x)) * view.camera.fx;
    const double gy = (sample.dy + gradient.dot(along_y)) * view.camera.fy;
    const double inverse_z = 1 / y.z();
    const Eigen::Vector3d h(gx * inverse_z,
                            gy * inverse_z,
                            -(gx * y.x() + gy * y.y()) * inverse_z * inverse_z);
    Eigen::Map<Vector6d> xi(row);
    xi << y.cross(h), h;
    for (int k = 0; k < 4; ++k) {
      row[6 + 2 * k] = w[k] * sample.dx;
      row[7 + 2 * k] = w[k] * sample.dy;
    }
  }
  return sample.value - point.color;
}

bool AnalyticCost::Evaluate(double const* const* parameters,
                            double* residuals,
                            double** jacobians) const {
  const Pose pose = PoseFromBlock(parameters[0]);
  double row[kColumns];
  residuals[0] = EvaluateObservation(view_,
                                     pose.RotationMatrix(),
                                     pose.translation,
                                     parameters + 1,
                                     point_,
                                     jacobians ? row : nullptr);
  if (jacobians) StoreRow(row, parameters[0], 0, jacobians);
  return true;
}

BatchedCost::BatchedCost(const CellView& view,
                         std::vector<ObservedPoint> points)
    : view_(view), points_(std::move(points)) {
  mutable_parameter_block_sizes()->push_back(kPoseSize);
  for (int k = 0; k < 4; ++k) mutable_parameter_block_sizes()->push_back(2);
  set_num_residuals(static_cast<int>(points_.size()));
}

bool BatchedCost::Evaluate(double const* const* parameters,
                           double* residuals,
                           double** jacobians) const {
  const Pose pose = PoseFromBlock(parameters[0]);
  const Eigen::Matrix3d rotation = pose.RotationMatrix();
  double row[kColumns];
  for (size_t i = 0; i < points_.size(); ++i) {
    residuals[i] = EvaluateObservation(view_,
                                       rotation,
                                       pose.translation,
                                       parameters + 1,
                                       points_[i],
                                       jacobians ? row : nullptr);
    if (jacobians) StoreRow(row, parameters[0], i, jacobians);
  }
  return true;
}

}  // namespace facet
