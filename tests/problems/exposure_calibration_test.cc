// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "problems/exposure_calibration.h"

#include <gtest/gtest.h>

#include <cmath>

#include "costs/exposure_cost.h"
#include "tests/support/tangent_jacobian.h"
#include "util/random.h"

namespace facet {
namespace {

using Blocks = std::vector<std::vector<double>>;

// Intensities that keyframes show of texels, and H of costs/exposure_cost.h.
struct Views {
  std::vector<std::vector<std::pair<int, double>>> texels;
  Eigen::MatrixXd hessian;
};

Views RandomViews(int num_keyframes, int num_texels, Random* random) {
  Views views;
  views.hessian = Eigen::MatrixXd::Zero(2 * num_keyframes, 2 * num_keyframes);
  for (int t = 0; t < num_texels; ++t) {
    std::vector<std::pair<int, double>> seen;
    for (int k = 0; k < num_keyframes; ++k) {
      if (random->Uniform() < 0.6) seen.emplace_back(k, random->Uniform());
    }
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(
        static_cast<Eigen::Index>(seen.size()), views.hessian.cols());
    for (size_t i = 0; i < seen.size(); ++i) {
      rows(static_cast<Eigen::Index>(i), 2 * seen[i].first) = seen[i].second;
      rows(static_cast<Eigen::Index>(i), 2 * seen[i].first + 1) = 1;
    }
    rows.rowwise() -= rows.colwise().mean().eval();
    if (!seen.empty()) views.hessian += rows.transpose() * rows;
    views.texels.push_back(seen);
  }
  return views;
}

// The quadratic form is the sum over the texels, and its Jacobian that of
// differences. Breaks if colours are not eliminated or the factor is
// transposed.
TEST(ExposureCost, EqualsTheSumOverTexels) {
  Random random(3);
  const int kKeyframes = 5;
  const Views views = RandomViews(kKeyframes, 200, &random);
  const ExposureConsistencyCost cost(views.hessian);
  TangentBlocks blocks;
  for (int k = 0; k < kKeyframes; ++k) {
    blocks.values.push_back({1 + 0.2 * random.Normal(), 0.1 * random.Normal()});
    blocks.manifolds.push_back(nullptr);
  }
  double expected = 0;
  for (const auto& seen : views.texels) {
    double mean = 0;
    const auto corrected = [&](const std::pair<int, double>& view) {
      const auto& x = blocks.values[view.first];
      return x[0] * view.second + x[1];
    };
    for (const auto& view : seen) {
      mean += corrected(view) / static_cast<double>(seen.size());
    }
    for (const auto& view : seen) {
      expected += std::pow(corrected(view) - mean, 2);
    }
  }
  Eigen::VectorXd r;
  const Eigen::MatrixXd j = TangentJacobian(cost, blocks, &r);
  EXPECT_NEAR(r.squaredNorm(), expected, 1e-9 * expected);
  EXPECT_LT((j - DifferenceJacobian(cost, blocks, 1e-5)).norm(),
            1e-6 * j.norm());
}

// The terms that hold the gauge: residuals and derivatives. Breaks if a weight
// or a share goes to the wrong parameter.
TEST(ExposureCost, MeansAndPriorsAreWhatTheySay) {
  const Blocks values = {{1.1, 0.02}, {0.8, -0.04}};
  const std::unique_ptr<ceres::CostFunction> mean(
      ExposureMeanCost::Create({0.25, 0.75}, 10));
  const Eigen::VectorXd m = Residuals(*mean, values);
  EXPECT_NEAR(m[0], 10 * (0.25 * 1.1 + 0.75 * 0.8 - 1), 1e-12);
  EXPECT_NEAR(m[1], 10 * (0.25 * 0.02 - 0.75 * 0.04), 1e-12);
  const std::unique_ptr<ceres::CostFunction> prior(
      ExposurePriorCost::Create(3, 5));
  const Eigen::VectorXd p = Residuals(*prior, {values[1]});
  EXPECT_NEAR(p[0], 3 * (0.8 - 1), 1e-12);
  EXPECT_NEAR(p[1], 5 * -0.04, 1e-12);
  const TangentBlocks blocks = {values, {nullptr, nullptr}};
  Eigen::VectorXd r;
  const Eigen::MatrixXd j = TangentJacobian(*mean, blocks, &r);
  EXPECT_LT((j - DifferenceJacobian(*mean, blocks, 1e-5)).norm(), 1e-6);
}

// A textured wall seen by cameras in a row, each with an exposure of its own.
struct Wall {
  Pinhole camera = {60, 60, 39.5, 29.5, 80, 60};
  TexelSet texels;
  Observations observations;
  std::vector<Plane> planes;
  std::vector<Pose> poses;
  KeyframeImages images;
  std::vector<Exposure> camera_exposure;  // seen = gain * true + offset

  static double Paint(double x, double y, int channel) {
    return 0.5 + 0.12 * std::sin(9 * x + channel) +
           0.12 * std::sin(7 * y - 2 * channel);
  }
};

Wall MakeWall(int num_keyframes) {
  Wall wall;
  Random random(5);
  wall.planes = {Plane{Eigen::Vector3d(0, 0, -1), 1.0}};  // z = 1
  wall.texels.spacing_m = 0.02;
  for (double x = -1; x < 2; x += 0.02) {
    for (double y = -0.4; y < 0.4; y += 0.02) {
      wall.texels.position.emplace_back(x, y, 1);
      wall.texels.plane.push_back(0);
    }
  }
  wall.observations.begin.push_back(0);
  for (int k = 0; k < num_keyframes; ++k) {
    Pose pose;
    pose.translation = {-0.15 * k, 0, 0};
    wall.poses.push_back(pose);
    Exposure exposure;
    for (int c = 0; c < 3; ++c) {
      exposure.gain[c] = static_cast<float>(1 + 0.1 * random.Normal());
      exposure.offset[c] = static_cast<float>(0.03 * random.Normal());
    }
    wall.camera_exposure.push_back(exposure);
    cv::Mat rgb(wall.camera.height, wall.camera.width, CV_8UC3);
    for (int v = 0; v < rgb.rows; ++v) {
      for (int u = 0; u < rgb.cols; ++u) {
        const Eigen::Vector3d p = wall.camera.Unproject(u, v);
        for (int c = 0; c < 3; ++c) {
          const double seen =
              exposure.gain[c] * Wall::Paint(p.x() + 0.15 * k, p.y(), c) +
              exposure.offset[c];
          rgb.at<cv::Vec3b>(v, u)[c] = cv::saturate_cast<uint8_t>(255 * seen);
        }
      }
    }
    wall.images.rgb.push_back(rgb);
    for (uint32_t i = 0; i < wall.texels.size(); ++i) {
      const Eigen::Vector2d u = wall.camera.Project<double>(
          pose * wall.texels.position[i].cast<double>());
      if (u.x() >= 1 && u.x() <= 78 && u.y() >= 1 && u.y() <= 58) {
        wall.observations.texel.push_back(i);
      }
    }
    wall.observations.begin.push_back(wall.observations.texel.size());
  }
  return wall;
}

ExposureCalibration Calibrate(const Wall& wall) {
  return CalibrateExposures(wall.texels,
                            wall.observations,
                            wall.planes,
                            wall.camera,
                            wall.poses,
                            wall.images,
                            ExposureOptions());
}

// The exposures found undo those of the cameras but for what is common to all:
// a grey becomes the same grey in every keyframe. Breaks if keyframes, channels
// or the direction of the map are mixed up.
TEST(ExposureCalibration, UndoesTheExposuresOfTheCameras) {
  const Wall wall = MakeWall(9);
  const ExposureCalibration found = Calibrate(wall);
  ASSERT_EQ(found.exposures.size(), 9u);
  EXPECT_GT(found.rms_before, 5);
  EXPECT_LT(found.rms_after, 1);
  for (int c = 0; c < 3; ++c) {
    for (const float grey : {0.35f, 0.65f}) {
      double low = 1, high = 0, mean_gain = 0;
      for (size_t k = 0; k < 9; ++k) {
        const Exposure& seen = wall.camera_exposure[k];
        const Exposure& undo = found.exposures[k];
        const double common =
            undo.gain[c] * (seen.gain[c] * grey + seen.offset[c]) +
            undo.offset[c];
        low = std::min(low, common);
        high = std::max(high, common);
        mean_gain += undo.gain[c] / 9;
      }
      EXPECT_LT(high - low, 0.012) << "channel " << c;
      EXPECT_NEAR(mean_gain, 1, 0.02);
    }
  }
}

// Keyframes that see nothing in common with others stay as taken, and cameras
// that agree are left alone. Breaks if the prior or the mean is lost: gains
// would fall to 0, where all images agree.
TEST(ExposureCalibration, LeavesAgreeingCamerasAlone) {
  Wall wall = MakeWall(4);
  for (size_t k = 1; k < 4; ++k) wall.poses[k] = wall.poses[0];
  for (size_t k = 1; k < 4; ++k) wall.images.rgb[k] = wall.images.rgb[0];
  const size_t seen = wall.observations.begin[1];
  wall.observations.texel.resize(seen);
  for (size_t k = 1; k < 3; ++k) {
    wall.observations.begin[k + 1] = (k + 1) * seen;
    wall.observations.texel.insert(
        wall.observations.texel.end(),
        wall.observations.texel.begin(),
        wall.observations.texel.begin() + static_cast<std::ptrdiff_t>(seen));
  }
  wall.observations.begin[4] = 3 * seen;  // the last keyframe sees nothing
  const ExposureCalibration found = Calibrate(wall);
  for (const Exposure& exposure : found.exposures) {
    for (int c = 0; c < 3; ++c) {
      EXPECT_NEAR(exposure.gain[c], 1, 1e-3);
      EXPECT_NEAR(exposure.offset[c], 0, 1e-3);
    }
  }
}

// A keyframe that shows a negative fits no camera: it stays as taken, and the
// texture is never divided by a gain near 0. Breaks without the bound on gains.
TEST(ExposureCalibration, ImpossibleKeyframesStayAsTaken) {
  Wall wall = MakeWall(9);
  cv::bitwise_not(wall.images.rgb[4], wall.images.rgb[4]);
  const ExposureCalibration found = Calibrate(wall);
  EXPECT_EQ((found.exposures[4].gain - 1).abs().maxCoeff(), 0);
  EXPECT_EQ(found.exposures[4].offset.abs().maxCoeff(), 0);
  for (const Exposure& exposure : found.exposures) {
    EXPECT_GE(exposure.gain.minCoeff(), 0.25f);
  }
}

// Luma, smooth images and channels follow the exposure. Breaks if one of them
// is made from the images as taken.
TEST(KeyframeImages, ExposuresChangeLumaAndChannelsAlike) {
  KeyframeImages images;
  images.rgb = {cv::Mat(4, 5, CV_8UC3, cv::Scalar(51, 102, 204))};
  Exposure exposure;
  exposure.gain = {1.5f, 0.5f, 1.0f};
  exposure.offset = {-0.1f, 0.2f, 0.0f};
  SetExposures({exposure}, 0.8, &images);
  const float red = 0.2f, green = 0.4f, blue = 0.8f;  // 0.2 stays, 0.4 stays
  EXPECT_NEAR(LumaOf(images, 0).at<float>(2, 2),
              0.299f * red + 0.587f * green + 0.114f * blue,
              1e-6);
  EXPECT_NEAR(images.smooth[0].at<float>(1, 3),
              LumaOf(images, 0).at<float>(2, 2),
              1e-6);
  const auto channels = SmoothChannels(images.rgb[0], exposure, 0);
  EXPECT_NEAR(channels[0].at<float>(0, 0), red, 1e-6);
  EXPECT_NEAR(channels[1].at<float>(0, 0), green, 1e-6);
  EXPECT_NEAR(exposure.Corrected({51, 102, 204})[1], 255 * green, 1e-3);
  SetExposures({}, 0, &images);
  EXPECT_NEAR(images.smooth[0].at<float>(2, 2),
              LumaFromRgb(images.rgb[0]).at<float>(2, 2),
              1e-7);
}

}  // namespace
}  // namespace facet
