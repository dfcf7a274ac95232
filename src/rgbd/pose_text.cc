// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "rgbd/pose_text.h"

#include <Eigen/SVD>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <sstream>

namespace facet {
namespace {

constexpr double kRigidTolerance = 1e-2;

bool ParseNumber(const std::string& token, double* number) {
  if (token.find("#INF") != std::string::npos) {
    *number =
        (token[0] == '-' ? -1 : 1) * std::numeric_limits<double>::infinity();
    return true;
  }
  if (token.find("#IND") != std::string::npos ||
      token.find("#QNAN") != std::string::npos) {
    *number = std::numeric_limits<double>::quiet_NaN();
    return true;
  }
  char* end = nullptr;
  *number = std::strtod(token.c_str(), &end);
  return end != token.c_str() && *end == '\0';
}

}  // namespace

bool ParseNumbers(const std::string& text, std::vector<double>* numbers) {
  numbers->clear();
  std::istringstream stream(text);
  std::string token;
  double number;
  while (stream >> token) {
    if (!ParseNumber(token, &number)) return false;
    numbers->push_back(number);
  }
  return true;
}

PoseState ReadRigid(const Eigen::Matrix4d& matrix, Pose* pose) {
  if (!matrix.allFinite() || matrix.isZero(0)) return PoseState::kLost;
  const Eigen::Matrix3d r = matrix.topLeftCorner<3, 3>();
  const Eigen::RowVector4d last_row(0, 0, 0, 1);
  if (std::abs(r.determinant() - 1) > kRigidTolerance ||
      (r.transpose() * r - Eigen::Matrix3d::Identity()).norm() >
          kRigidTolerance ||
      (matrix.row(3) - last_row).norm() > kRigidTolerance) {
    return PoseState::kNotRigid;
  }
  // det R is close to 1, so U V^T is a rotation, not a reflection.
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(
      r, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d nearest = svd.matrixU() * svd.matrixV().transpose();
  *pose = Pose(Eigen::Quaterniond(nearest), matrix.topRightCorner<3, 1>());
  return PoseState::kRigid;
}

Eigen::Matrix4d RowMajor4x4(const double* numbers) {
  return Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(
      numbers);
}

std::string FormatPose(const Pose& pose) {
  const Eigen::Matrix4d m = pose.Matrix();
  std::string text;
  char number[32];
  for (int i = 0; i < 16; ++i) {
    std::snprintf(number, sizeof(number), "%.12g", m(i / 4, i % 4));
    if (i > 0) text += ' ';
    text += number;
  }
  return text;
}

}  // namespace facet
