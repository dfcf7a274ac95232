// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Jacobians of a cost function in the tangent spaces of its parameter blocks:
// the one it returns, and central differences through Manifold::Plus.
#pragma once

#include <ceres/cost_function.h>
#include <ceres/manifold.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <vector>

namespace facet {

// One manifold a block, null = Euclidean. Values are the current state.
struct TangentBlocks {
  std::vector<std::vector<double>> values;
  std::vector<const ceres::Manifold*> manifolds;

  int TangentSize(size_t block) const {
    return manifolds[block] ? manifolds[block]->TangentSize()
                            : static_cast<int>(values[block].size());
  }
  int TangentSize() const {
    int n = 0;
    for (size_t b = 0; b < values.size(); ++b) n += TangentSize(b);
    return n;
  }
};

inline Eigen::VectorXd Residuals(
    const ceres::CostFunction& cost,
    const std::vector<std::vector<double>>& values) {
  std::vector<const double*> parameters;
  for (const auto& v : values) parameters.push_back(v.data());
  Eigen::VectorXd r(cost.num_residuals());
  EXPECT_TRUE(cost.Evaluate(parameters.data(), r.data(), nullptr));
  return r;
}

// Returns J (residuals x tangent) and sets *residuals, both as the cost
// function gives them when asked for Jacobians.
inline Eigen::MatrixXd TangentJacobian(const ceres::CostFunction& cost,
                                       const TangentBlocks& blocks,
                                       Eigen::VectorXd* residuals) {
  using RowMajor =
      Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const int rows = cost.num_residuals();
  std::vector<const double*> parameters;
  std::vector<std::vector<double>> storage;
  std::vector<double*> jacobians;
  for (const auto& v : blocks.values) {
    parameters.push_back(v.data());
    storage.emplace_back(rows * v.size());
  }
  for (auto& s : storage) jacobians.push_back(s.data());
  residuals->resize(rows);
  EXPECT_TRUE(
      cost.Evaluate(parameters.data(), residuals->data(), jacobians.data()));
  Eigen::MatrixXd result(rows, blocks.TangentSize());
  int column = 0;
  for (size_t b = 0; b < blocks.values.size(); ++b) {
    const int ambient = static_cast<int>(blocks.values[b].size());
    const int tangent = blocks.TangentSize(b);
    const Eigen::Map<const RowMajor> j(storage[b].data(), rows, ambient);
    RowMajor plus = RowMajor::Identity(ambient, tangent);
    if (blocks.manifolds[b]) {
      blocks.manifolds[b]->PlusJacobian(parameters[b], plus.data());
    }
    result.middleCols(column, tangent) = j * plus;
    column += tangent;
  }
  return result;
}

inline Eigen::MatrixXd DifferenceJacobian(const ceres::CostFunction& cost,
                                          const TangentBlocks& blocks,
                                          double h) {
  Eigen::MatrixXd result(cost.num_residuals(), blocks.TangentSize());
  int column = 0;
  for (size_t b = 0; b < blocks.values.size(); ++b) {
    for (int k = 0; k < blocks.TangentSize(b); ++k, ++column) {
      Eigen::VectorXd r[2];
      for (const int side : {0, 1}) {
        Eigen::VectorXd delta = Eigen::VectorXd::Zero(blocks.TangentSize(b));
        delta[k] = side == 0 ? -h : h;
        std::vector<std::vector<double>> values = blocks.values;
        if (blocks.manifolds[b]) {
          blocks.manifolds[b]->Plus(
              blocks.values[b].data(), delta.data(), values[b].data());
        } else {
          values[b][k] += delta[k];
        }
        r[side] = Residuals(cost, values);
      }
      result.col(column) = (r[1] - r[0]) / (2 * h);
    }
  }
  return result;
}

}  // namespace facet
