// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "costs/frame_cell_cost.h"

#include <gtest/gtest.h>

#include <memory>

#include "costs/compressed_block.h"
#include "costs/robust_loss.h"
#include "tests/costs/photo_scene.h"
#include "tests/support/tangent_jacobian.h"

namespace facet {
namespace {

// The image gradient, about 0.002 per px, is a difference of intensities of
// about 0.5 in float: 6e-8 / 0.002 = 3e-5 of it is rounding. Pixel positions
// add less (1e-5 px), the diagonal shift of the compression 5e-7. Entries are
// compared relative to |J_i||J_j|.
constexpr double kFloatTolerance = 1e-4;
// With and without Jacobians the same float residuals are summed in another
// order, and the compression is exact for the cost.
constexpr double kSameCostTolerance = 2e-6;

struct Triple {
  Eigen::MatrixXd hessian;
  Eigen::VectorXd gradient;
  double cost = 0;  // r^T r
};

Triple TripleOf(const Eigen::MatrixXd& j, const Eigen::VectorXd& r) {
  return {j.transpose() * j, j.transpose() * r, r.squaredNorm()};
}

void ExpectNear(const Triple& expected, const Triple& found) {
  const Eigen::VectorXd scale = expected.hessian.diagonal().cwiseSqrt();
  for (int i = 0; i < scale.size(); ++i) {
    EXPECT_NEAR(found.gradient[i],
                expected.gradient[i],
                kFloatTolerance * scale[i] * std::sqrt(expected.cost))
        << i;
    for (int k = 0; k < scale.size(); ++k) {
      EXPECT_NEAR(found.hessian(i, k),
                  expected.hessian(i, k),
                  kFloatTolerance * scale[i] * scale[k])
          << i << " " << k;
    }
  }
  EXPECT_NEAR(found.cost, expected.cost, kFloatTolerance * expected.cost);
}

constexpr int kCellA = 2, kCellB = 1;

std::vector<std::vector<double>> CellVertices(const PhotoScene& s,
                                              bool with_warp) {
  if (!with_warp) return {{0, 0}, {0, 0}, {0, 0}, {0, 0}};
  return {s.Vertex(kCellA, kCellB),
          s.Vertex(kCellA + 1, kCellB),
          s.Vertex(kCellA, kCellB + 1),
          s.Vertex(kCellA + 1, kCellB + 1)};
}

// Sums of the double reference over (omega, upsilon | f00 f10 f01 f11).
Triple Reference(const PhotoScene& s,
                 const TestImage& image,
                 bool with_warp,
                 double weight) {
  const LeftSe3Manifold manifold;
  const int n = with_warp ? 14 : 6;
  Triple sum = {Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n), 0};
  for (size_t i = 0; i < s.p.size(); ++i) {
    const std::unique_ptr<ceres::CostFunction> cost(
        PhotometricCost::Create(PhotometricCost(image.view(),
                                                s.camera,
                                                s.lattice,
                                                kCellA,
                                                kCellB,
                                                s.p[i],
                                                s.anchor)));
    TangentBlocks blocks;
    blocks.values = {s.pose, s.plane, {s.plane_texels[i].color}};
    for (const auto& v : CellVertices(s, with_warp)) blocks.values.push_back(v);
    blocks.manifolds.assign(7, nullptr);
    blocks.manifolds[0] = &manifold;
    Eigen::VectorXd r;
    const Eigen::MatrixXd all = TangentJacobian(*cost, blocks, &r);
    Eigen::MatrixXd j(1, n);
    j.leftCols(6) = all.leftCols(6);
    if (with_warp) j.rightCols(8) = all.rightCols(8);
    const Triple one = TripleOf(j, r);
    sum.hessian += weight * one.hessian;
    sum.gradient += weight * one.gradient;
    sum.cost += weight * one.cost;
  }
  return sum;
}

// One block of many texels equals the sum of the reference's residuals. The
// texels lie in several cells: all must follow the polynomial of the given one.
// Numbers of texels around the lane width show errors in the padding.
TEST(FrameCellCost, EqualsTheSumOfTheReference) {
  Random random(1);
  const LeftSe3Manifold manifold;
  for (const bool with_warp : {false, true}) {
    for (const size_t n : {30, 63, 64, 65, 200}) {
      const TestImage image = BilinearImage(&random);
      const PhotoScene s = MakePhotoScene(n, &random);
      const double weight = 4;
      const FrameCellCost cost(s.Frame(image),
                               s.origin,
                               kCellA,
                               kCellB,
                               s.plane_texels.data(),
                               s.ids.data(),
                               n,
                               with_warp,
                               weight);
      TangentBlocks blocks;
      blocks.values = {s.pose};
      blocks.manifolds = {&manifold};
      if (with_warp) {
        for (const auto& v : CellVertices(s, true)) blocks.values.push_back(v);
        blocks.manifolds.resize(5, nullptr);
      }
      Eigen::VectorXd r;
      const Eigen::MatrixXd j = TangentJacobian(cost, blocks, &r);
      ExpectNear(Reference(s, image, with_warp, weight), TripleOf(j, r));
      EXPECT_NEAR(Residuals(cost, blocks.values).squaredNorm(),
                  r.squaredNorm(),
                  kSameCostTolerance * r.squaredNorm());
    }
  }
}

// Ceres passes null for constant blocks. Breaks if a null Jacobian is written,
// or if the others change.
TEST(FrameCellCost, ConstantBlocksMayBeLeftOut) {
  Random random(2);
  const TestImage image = BilinearImage(&random);
  const PhotoScene s = MakePhotoScene(100, &random);
  const FrameCellCost cost(s.Frame(image),
                           s.origin,
                           kCellA,
                           kCellB,
                           s.plane_texels.data(),
                           s.ids.data(),
                           100,
                           true,
                           1);
  std::vector<std::vector<double>> values = {s.pose};
  for (const auto& v : CellVertices(s, true)) values.push_back(v);
  std::vector<const double*> parameters;
  for (const auto& v : values) parameters.push_back(v.data());
  Eigen::VectorXd r_all(15), r_one(15);
  std::vector<double> pose(15 * 7), f00(30), f10(30), f01(30), f11(30),
      only(30);
  double* all[] = {pose.data(), f00.data(), f10.data(), f01.data(), f11.data()};
  double* one[] = {nullptr, nullptr, only.data(), nullptr, nullptr};
  ASSERT_TRUE(cost.Evaluate(parameters.data(), r_all.data(), all));
  ASSERT_TRUE(cost.Evaluate(parameters.data(), r_one.data(), one));
  EXPECT_EQ(r_all, r_one);
  EXPECT_EQ(f10, only);
}

// A wall without texture says nothing about the pose: rows of zeros, the cost
// kept, no NaN.
TEST(FrameCellCost, BlankImageGivesZeroRowsAndTheRightCost) {
  Random random(3);
  TestImage image = BilinearImage(&random);
  for (float& x : image.pixels) x = 0.5f;
  const PhotoScene s = MakePhotoScene(100, &random);
  const FrameCellCost cost(s.Frame(image),
                           s.origin,
                           kCellA,
                           kCellB,
                           s.plane_texels.data(),
                           s.ids.data(),
                           100,
                           true,
                           1);
  const LeftSe3Manifold manifold;
  TangentBlocks blocks;
  blocks.values = {s.pose};
  for (const auto& v : CellVertices(s, true)) blocks.values.push_back(v);
  blocks.manifolds = {&manifold, nullptr, nullptr, nullptr, nullptr};
  Eigen::VectorXd r;
  const Eigen::MatrixXd j = TangentJacobian(cost, blocks, &r);
  EXPECT_EQ(j.norm(), 0);
  double expected = 0;
  for (const PhotoTexel& texel : s.plane_texels) {
    expected += (0.5 - texel.color) * (0.5 - texel.color);
  }
  EXPECT_NEAR(r.squaredNorm(), expected, kFloatTolerance * expected);
}

// With a robust loss the rows are weighted, yet cost and gradient are those of
// sum rho: cost with Jacobian = without = the sum in double, gradient = sum
// rho' r J. Colours differ by up to 0.2 from the image, the scale lies in
// between.
TEST(FrameCellCost, RobustBlocksKeepCostAndGradient) {
  Random random(4);
  const LeftSe3Manifold manifold;
  const size_t n = 200;
  for (const LossKind loss :
       {LossKind::kHuber, LossKind::kCauchy, LossKind::kTukey}) {
    const double scale = 0.1;
    const TestImage image = BilinearImage(&random);
    const PhotoScene s = MakePhotoScene(n, &random);
    PhotoFrame frame = s.Frame(image);
    frame.loss = loss;
    frame.loss_scale = static_cast<float>(scale);
    const FrameCellCost cost(frame,
                             s.origin,
                             kCellA,
                             kCellB,
                             s.plane_texels.data(),
                             s.ids.data(),
                             n,
                             true,
                             4);
    TangentBlocks blocks;
    blocks.values = {s.pose};
    for (const auto& v : CellVertices(s, true)) blocks.values.push_back(v);
    blocks.manifolds = {&manifold, nullptr, nullptr, nullptr, nullptr};
    Eigen::VectorXd r;
    const Eigen::MatrixXd j = TangentJacobian(cost, blocks, &r);
    double expected_cost = 0;
    Eigen::VectorXd expected = Eigen::VectorXd::Zero(14);
    double expected_scale = 0;
    for (size_t i = 0; i < n; ++i) {
      PhotoScene one = s;
      one.p = {s.p[i]};
      const std::unique_ptr<ceres::CostFunction> reference(
          PhotometricFrameCost::Create(
              PhotometricFrameCost(PhotometricCost(image.view(),
                                                   s.camera,
                                                   s.lattice,
                                                   kCellA,
                                                   kCellB,
                                                   s.p[i],
                                                   s.anchor),
                                   s.plane.data(),
                                   s.plane_texels[i].color),
              true));
      Eigen::VectorXd ri;
      const Eigen::MatrixXd ji = TangentJacobian(*reference, blocks, &ri);
      const double squared = ri[0] * ri[0];
      expected_cost += 4 * LossValue(loss, scale, squared);
      expected += 4 * LossWeight(loss, scale, squared) * ri[0] * ji.transpose();
      expected_scale += ji.norm();
    }
    EXPECT_NEAR(r.squaredNorm(), expected_cost, 1e-5 * expected_cost);
    EXPECT_NEAR(Residuals(cost, blocks.values).squaredNorm(),
                r.squaredNorm(),
                1e-9 * r.squaredNorm());
    EXPECT_LT((j.transpose() * r - expected).norm(),
              kFloatTolerance * expected_scale);
  }
}

}  // namespace
}  // namespace facet
