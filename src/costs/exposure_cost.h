// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Consistency of the exposures of all keyframes in one channel, the colours
// eliminated (texture/exposure.h):
//
//   E = sum over texels of sum_k (a_k I_k + b_k - C)^2,
//       C = mean over the keyframes of a_k I_k + b_k
//     = x^T H x,   x = (a_1, b_1, a_2, b_2, ...)
//
// For the best C this is a quadratic form: no texel is visited again.
//
// Residual    L^T x with H + eps I = L L^T               2 a keyframe
// Parameters  (gain, offset) of each keyframe            2 each
//
// Alone, E is 0 for gains of 0 and blind to a common offset: ExposureMeanCost
// holds both means.
#pragma once

#include <ceres/autodiff_cost_function.h>
#include <ceres/dynamic_autodiff_cost_function.h>

#include <Eigen/Cholesky>
#include <utility>
#include <vector>

namespace facet {

class ExposureConsistencyCost : public ceres::CostFunction {
 public:
  // `hessian` is H, 2 K x 2 K, symmetric and positive semidefinite; the lower
  // triangle is read. eps is 1e-12 of its largest element, more where rounding
  // asks for it.
  explicit ExposureConsistencyCost(Eigen::MatrixXd hessian) {
    Eigen::LLT<Eigen::MatrixXd> llt;
    double eps = 1e-12 * hessian.diagonal().maxCoeff() + 1e-300;
    do {  // rounding can leave a singular H below zero
      hessian.diagonal().array() += eps;
      llt.compute(hessian);
      eps *= 10;
    } while (llt.info() != Eigen::Success);
    factor_ = llt.matrixU();
    set_num_residuals(static_cast<int>(factor_.rows()));
    mutable_parameter_block_sizes()->assign(factor_.rows() / 2, 2);
  }

  bool Evaluate(double const* const* parameters,
                double* residuals,
                double** jacobians) const override {
    const int n = num_residuals();
    Eigen::VectorXd x(n);
    for (int k = 0; k < n / 2; ++k) {
      x.segment<2>(2 * k) = Eigen::Map<const Eigen::Vector2d>(parameters[k]);
    }
    Eigen::Map<Eigen::VectorXd>(residuals, n).noalias() = factor_ * x;
    for (int k = 0; jacobians && k < n / 2; ++k) {
      if (!jacobians[k]) continue;
      Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor>>(
          jacobians[k], n, 2) = factor_.middleCols<2>(2 * k);
    }
    return true;
  }

 private:
  Eigen::MatrixXd factor_;  // L^T
};

// Holds the weighted means of the gains at 1 and of the offsets at 0.
//
// Residual    weight (sum_k w_k a_k - 1, sum_k w_k b_k)       2
// Parameters  (gain, offset) of each keyframe                 2 each
class ExposureMeanCost {
 public:
  // `shares` w_k sum to 1.
  ExposureMeanCost(std::vector<double> shares, double weight)
      : shares_(std::move(shares)), weight_(weight) {}

  template <typename T>
  bool operator()(T const* const* exposures, T* residual) const {
    residual[0] = T(-weight_);
    residual[1] = T(0);
    for (size_t k = 0; k < shares_.size(); ++k) {
      residual[0] += weight_ * shares_[k] * exposures[k][0];
      residual[1] += weight_ * shares_[k] * exposures[k][1];
    }
    return true;
  }

  static ceres::CostFunction* Create(const std::vector<double>& shares,
                                     double weight) {
    auto* cost = new ceres::DynamicAutoDiffCostFunction<ExposureMeanCost, 64>(
        new ExposureMeanCost(shares, weight));
    for (size_t k = 0; k < shares.size(); ++k) cost->AddParameterBlock(2);
    cost->SetNumResiduals(2);
    return cost;
  }

 private:
  std::vector<double> shares_;
  double weight_;
};

// Prior of one keyframe: gain 1, offset 0.
//
// Residual    ((a - 1) weight_gain, b weight_offset)          2
// Parameters  (gain, offset)                                  2
class ExposurePriorCost {
 public:
  ExposurePriorCost(double weight_gain, double weight_offset)
      : weight_gain_(weight_gain), weight_offset_(weight_offset) {}

  template <typename T>
  bool operator()(const T* exposure, T* residual) const {
    residual[0] = weight_gain_ * (exposure[0] - 1.0);
    residual[1] = weight_offset_ * exposure[1];
    return true;
  }

  static ceres::CostFunction* Create(double weight_gain, double weight_offset) {
    return new ceres::AutoDiffCostFunction<ExposurePriorCost, 2, 2>(
        new ExposurePriorCost(weight_gain, weight_offset));
  }

 private:
  double weight_gain_, weight_offset_;
};

}  // namespace facet
