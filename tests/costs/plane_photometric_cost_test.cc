// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "costs/plane_photometric_cost.h"

#include <gtest/gtest.h>

#include <memory>

#include "tests/costs/photo_scene.h"
#include "tests/support/tangent_jacobian.h"

namespace facet {
namespace {

// As in frame_cell_cost_test.cc: image gradients of about 0.002 per px are
// float differences of intensities of 0.5, good to 3e-5.
constexpr double kFloatTolerance = 1e-4;
// Another order of the same float sums.
constexpr double kSameCostTolerance = 2e-6;

// Two keyframes, the second one with a warp, and overlapping sets of texels.
class PlanePhotometricCostTest : public testing::Test {
 protected:
  PlanePhotometricCostTest()
      : random_(1),
        images_{BilinearImage(&random_), BilinearImage(&random_)},
        scene_(MakePhotoScene(150, &random_)),
        poses_(2, scene_.pose) {
    Vector6d xi = 0.02 * Vector6d::Ones();
    PoseToBlock(ExpSe3(xi) * PoseFromBlock(scene_.pose.data()),
                poses_[1].data());
    warp_.assign(scene_.warp.begin(), scene_.warp.end());
    for (int k = 0; k < 2; ++k) {
      frames_.push_back(scene_.Frame(images_[k]));
      SetFramePose(poses_[k].data(), scene_.origin, &frames_.back());
    }
    frames_[1].warp = warp_.data();
    segments_ = {{0, scene_.ids.data(), 100}, {1, scene_.ids.data() + 50, 100}};
  }

  PlanePhotometricCost Cost(double weight) const {
    return PlanePhotometricCost(frames_,
                                segments_,
                                scene_.mesh_texels.data(),
                                scene_.anchor - scene_.origin,
                                weight);
  }

  // Sum over the reference: Gram matrix of (ambient plane | r).
  Eigen::Matrix<double, 5, 5> Reference() const {
    Eigen::Matrix<double, 5, 5> sum = Eigen::Matrix<double, 5, 5>::Zero();
    for (const PlaneSegment& segment : segments_) {
      const int k = segment.keyframe;
      for (size_t n = 0; n < segment.num_ids; ++n) {
        const uint32_t i = segment.ids[n];
        PhotoScene at = scene_;
        at.pose = poses_[k];
        if (k == 0) at.warp.assign(at.warp.size(), 0.0);
        const Eigen::Vector2d u = at.PixelOf(i);
        const WarpCell cell = at.lattice.Locate(u.x(), u.y());
        const std::unique_ptr<ceres::CostFunction> cost(
            PhotometricCost::Create(PhotometricCost(images_[k].view(),
                                                    at.camera,
                                                    at.lattice,
                                                    cell.a,
                                                    cell.b,
                                                    at.p[i],
                                                    at.anchor)));
        TangentBlocks blocks;
        blocks.values = {at.pose,
                         at.plane,
                         {at.mesh_texels[i].color},
                         at.Vertex(cell.a, cell.b),
                         at.Vertex(cell.a + 1, cell.b),
                         at.Vertex(cell.a, cell.b + 1),
                         at.Vertex(cell.a + 1, cell.b + 1)};
        blocks.manifolds.assign(7, nullptr);
        Eigen::VectorXd r;
        Eigen::Matrix<double, 1, 5> row;
        row.head<4>() = TangentJacobian(*cost, blocks, &r).middleCols<4>(7);
        row[4] = r[0];
        sum += row.transpose() * row;
      }
    }
    return sum;
  }

  Random random_;
  std::vector<TestImage> images_;
  PhotoScene scene_;
  std::vector<std::vector<double>> poses_;
  std::vector<float> warp_;
  std::vector<PhotoFrame> frames_;
  std::vector<PlaneSegment> segments_;
};

// Breaks if a keyframe's texels are read with the pose, warp or cell of another
// one, or if a term of dq/d(n, d) is missing.
TEST_F(PlanePhotometricCostTest, EqualsTheSumOfTheReference) {
  const double weight = 9;
  TangentBlocks blocks;
  blocks.values = {scene_.plane};
  blocks.manifolds = {nullptr};
  const PlanePhotometricCost cost = Cost(weight);
  Eigen::VectorXd r;
  Eigen::MatrixXd jr(5, 5);
  jr.leftCols(4) = TangentJacobian(cost, blocks, &r);
  jr.col(4) = r;
  const Eigen::MatrixXd found = jr.transpose() * jr;
  const Eigen::MatrixXd expected = weight * Reference();
  const Eigen::VectorXd scale = expected.diagonal().cwiseSqrt();
  for (int i = 0; i < 5; ++i) {
    for (int k = 0; k < 5; ++k) {
      EXPECT_NEAR(
          found(i, k), expected(i, k), kFloatTolerance * scale[i] * scale[k])
          << i << " " << k;
    }
  }
  EXPECT_NEAR(Residuals(cost, blocks.values).squaredNorm(),
              r.squaredNorm(),
              kSameCostTolerance * r.squaredNorm());
}

// The derivative along the manifold, of the compressed cost itself: d(r^T r) =
// 2 J^T r. Central differences of a float cost: h = 1e-3 makes rounding
// (1e-6 / h) and truncation comparable; the image is exactly bilinear.
TEST_F(PlanePhotometricCostTest, GradientIsTheDerivativeOfTheCost) {
  const AnchoredPlaneManifold manifold;
  TangentBlocks blocks;
  blocks.values = {scene_.plane};
  blocks.manifolds = {&manifold};
  const PlanePhotometricCost cost = Cost(1);
  Eigen::VectorXd r;
  const Eigen::MatrixXd j = TangentJacobian(cost, blocks, &r);
  const double h = 1e-3;
  for (int k = 0; k < 3; ++k) {
    double sides[2];
    for (const int side : {0, 1}) {
      Eigen::Vector3d delta = Eigen::Vector3d::Zero();
      delta[k] = side == 0 ? -h : h;
      std::vector<std::vector<double>> values = blocks.values;
      manifold.Plus(scene_.plane.data(), delta.data(), values[0].data());
      sides[side] = Residuals(cost, values).squaredNorm();
    }
    EXPECT_NEAR((sides[1] - sides[0]) / (2 * h),
                2 * j.col(k).dot(r),
                5e-3 * j.col(k).norm() * r.norm());
  }
}

}  // namespace
}  // namespace facet
