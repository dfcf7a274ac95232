// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "problems/gauge.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "costs/se3_manifold.h"
#include "geometry/common_motion.h"

namespace facet {
namespace {

constexpr int kPointsPerCamera = 4;  // of CentersAndAxes

// The points of the cameras at the start and the inverse of their inertia.
class GaugePoints {
 public:
  explicit GaugePoints(const std::vector<Pose>& initial)
      : initial_(initial), points_(CentersAndAxes(initial)) {
    center_ = points_.rowwise().mean();
    Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
    for (Eigen::Index i = 0; i < points_.cols(); ++i) {
      const Eigen::Vector3d arm = points_.col(i) - center_;
      inertia += arm.squaredNorm() * Eigen::Matrix3d::Identity() -
                 arm * arm.transpose();
    }
    inverse_inertia_ = inertia.inverse();
  }

  Vector6d Motion(const std::vector<Pose>& cam_from_world) const {
    Eigen::Vector3d shift = Eigen::Vector3d::Zero();
    Eigen::Vector3d turn = Eigen::Vector3d::Zero();
    for (size_t i = 0; i < initial_.size(); ++i) {
      const Pose moved = cam_from_world[i].Inverse() * initial_[i];
      for (int k = 0; k < kPointsPerCamera; ++k) {
        const Eigen::Vector3d x = Point(i, k);
        const Eigen::Vector3d d = moved * x - x;
        shift += d;
        turn += (x - center_).cross(d);
      }
    }
    Vector6d motion;
    motion << inverse_inertia_ * turn,
        shift / static_cast<double>(points_.cols());
    return motion;
  }

  // Derivative of Motion w.r.t. the left increment of pose i: under Exp(xi) T
  // a point seen at y moves by -R^T (omega x y + upsilon).
  Eigen::Matrix<double, 6, 6> Jacobian(size_t i, const Pose& pose) const {
    const Eigen::Matrix3d rt = pose.RotationMatrix().transpose();
    Eigen::Matrix<double, 6, 6> sum = Eigen::Matrix<double, 6, 6>::Zero();
    for (int k = 0; k < kPointsPerCamera; ++k) {
      Eigen::Matrix<double, 3, 6> d;
      d << rt * Skew(initial_[i] * Point(i, k)), -rt;
      sum.topRows<3>() += Skew(Point(i, k) - center_) * d;
      sum.bottomRows<3>() += d;
    }
    sum.topRows<3>() = inverse_inertia_ * sum.topRows<3>();
    sum.bottomRows<3>() /= static_cast<double>(points_.cols());
    return sum;
  }

  // x -> Exp(omega) (x - c) + c + tau.
  Pose AsPose(const Vector6d& motion) const {
    Vector6d turn = Vector6d::Zero();
    turn.head<3>() = motion.head<3>();
    Pose pose = ExpSe3(turn);
    pose.translation = center_ + motion.tail<3>() - pose * center_;
    return pose;
  }

 private:
  Eigen::Vector3d Point(size_t camera, int k) const {
    return points_.col(kPointsPerCamera * static_cast<Eigen::Index>(camera) +
                       k);
  }

  const std::vector<Pose>& initial_;
  Eigen::Matrix3Xd points_;
  Eigen::Vector3d center_;
  Eigen::Matrix3d inverse_inertia_;
};

class CommonMotionCost : public ceres::CostFunction {
 public:
  CommonMotionCost(const std::vector<Pose>& initial, double weight)
      : initial_(initial), points_(initial_), weight_(weight) {
    mutable_parameter_block_sizes()->assign(initial_.size(), kPoseSize);
    set_num_residuals(6);
  }

  bool Evaluate(double const* const* parameters,
                double* residuals,
                double** jacobians) const override {
    std::vector<Pose> poses;
    for (size_t i = 0; i < initial_.size(); ++i) {
      poses.push_back(PoseFromBlock(parameters[i]));
    }
    Eigen::Map<Vector6d> r(residuals);
    r = weight_ * points_.Motion(poses);
    for (size_t i = 0; jacobians && i < initial_.size(); ++i) {
      if (!jacobians[i]) continue;
      Eigen::Map<Eigen::Matrix<double, 6, kPoseSize, Eigen::RowMajor>> j(
          jacobians[i]);
      j = weight_ * points_.Jacobian(i, poses[i]) * LeftPoseLift(parameters[i]);
    }
    return true;
  }

 private:
  std::vector<Pose> initial_;
  GaugePoints points_;
  double weight_;
};

}  // namespace

ceres::CostFunction* CreateCommonMotionCost(
    const std::vector<Pose>& initial_cam_from_world, double weight) {
  return new CommonMotionCost(initial_cam_from_world, weight);
}

void AddCommonMotionCost(const TextureProblem& problem,
                         double e_c,
                         ReconState* state,
                         ceres::Problem* ceres_problem) {
  std::vector<double*> parameters;
  for (int k = 0; k < problem.NumKeyframes(); ++k) {
    parameters.push_back(state->poses.data() + kPoseSize * k);
  }
  ceres_problem->AddResidualBlock(
      CreateCommonMotionCost(problem.initial_cam_from_world,
                             CommonMotionWeight(e_c)),
      nullptr,
      parameters);
}

Vector6d MeanMotion(const std::vector<Pose>& initial_cam_from_world,
                    const std::vector<Pose>& cam_from_world) {
  return GaugePoints(initial_cam_from_world).Motion(cam_from_world);
}

void RemoveCommonMotion(const TextureProblem& problem, ReconState* state) {
  if (problem.NumKeyframes() == 0) return;
  const GaugePoints points(problem.initial_cam_from_world);
  std::vector<Pose> poses;
  for (int k = 0; k < problem.NumKeyframes(); ++k) {
    poses.push_back(state->CamFromWorld(k));
  }
  // The definition is linear, the motion is not: repeat.
  for (int pass = 0; pass < 4; ++pass) {
    const Pose motion = points.AsPose(points.Motion(poses));
    for (Pose& pose : poses) pose = pose * motion;
  }
  for (int k = 0; k < problem.NumKeyframes(); ++k) {
    PoseToBlock(poses[k], state->poses.data() + kPoseSize * k);
  }
}

}  // namespace facet
