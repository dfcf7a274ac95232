// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "costs/robust_loss.h"

#include <ceres/loss_function.h>
#include <gtest/gtest.h>

#include <memory>

namespace facet {
namespace {

std::unique_ptr<ceres::LossFunction> OfCeres(LossKind kind, double scale) {
  switch (kind) {
    case LossKind::kHuber:
      return std::make_unique<ceres::HuberLoss>(scale);
    case LossKind::kCauchy:
      return std::make_unique<ceres::CauchyLoss>(scale);
    case LossKind::kTukey:
      return std::make_unique<ceres::TukeyLoss>(scale);
    default:
      return std::make_unique<ceres::TrivialLoss>();
  }
}

// Value and weight against Ceres's, the weight against central differences, and
// what compression relies on: rho(s) >= s rho'(s), rho' falls.
TEST(RobustLoss, IsThatOfCeresWithItsDerivative) {
  const double scale = 0.05;
  for (const LossKind kind : {LossKind::kSquared,
                              LossKind::kHuber,
                              LossKind::kCauchy,
                              LossKind::kTukey}) {
    const auto ceres_loss = OfCeres(kind, scale);
    double last_weight = 1;
    for (double r = 0.001; r < 0.4; r *= 1.13) {
      const double s = r * r, h = 1e-6 * s;
      double rho[3];
      ceres_loss->Evaluate(s, rho);
      const double value = LossValue(kind, scale, s);
      const double weight = LossWeight(kind, scale, s);
      EXPECT_NEAR(value, rho[0], 1e-12);
      EXPECT_NEAR(weight, rho[1], 1e-9);
      const double slope =
          (LossValue(kind, scale, s + h) - LossValue(kind, scale, s - h)) /
          (2 * h);
      EXPECT_NEAR(weight, slope, 1e-5);
      EXPECT_GE(value, s * weight - 1e-15);
      EXPECT_LE(weight, last_weight);
      last_weight = weight;
    }
    EXPECT_EQ(LossValue(kind, scale, 0), 0);
    EXPECT_EQ(LossWeight(kind, scale, 0), 1);
  }
}

}  // namespace
}  // namespace facet
