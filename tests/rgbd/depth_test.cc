// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "rgbd/depth.h"

#include <gtest/gtest.h>

#include <cmath>

#include "geometry/plane.h"

namespace facet {
namespace {

RgbdCalibration TwoCameras(int color_scale) {
  RgbdCalibration c;
  c.depth = {80, 82, 39.5, 29.5, 80, 60};
  const double s = color_scale;
  c.color = {75 * s,
             76 * s,
             40 * s - 0.5,
             30 * s - 0.5,
             80 * color_scale,
             60 * color_scale};
  c.color_from_depth = ExpSe3(
      (Vector6d() << 0.01, -0.015, 0.02, -0.03, 0.004, 0.002).finished());
  return c;
}

// z of the plane n.x = d in each pixel of a camera.
cv::Mat RenderPlane(const Pinhole& camera, const Eigen::Vector3d& n, double d) {
  cv::Mat depth(camera.height, camera.width, CV_32F);
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      depth.at<float>(y, x) =
          static_cast<float>(d / n.dot(camera.Unproject(x, y)));
    }
  }
  return depth;
}

// The warped depth of a plane is the plane seen from the colour camera, to
// rounding (1/z is linear in the image), with no pinhole even at three times
// the resolution. Breaks with a wrong extrinsic, interpolation of z, or a
// pixel lost between two triangles.
TEST(WarpDepthToColor, PlaneIsExactAndHasNoPinholes) {
  for (const int scale : {1, 3}) {
    const RgbdCalibration c = TwoCameras(scale);
    const Eigen::Vector3d n = Eigen::Vector3d(0.2, -0.3, 1).normalized();
    const double d = 1.5;
    const cv::Mat warped = WarpDepthToColor(RenderPlane(c.depth, n, d), c);
    ASSERT_EQ(warped.size(), cv::Size(c.color.width, c.color.height));
    const Eigen::Vector3d n_color = c.color_from_depth.rotation * n;
    const double d_color = d + n_color.dot(c.color_from_depth.translation);
    const cv::Mat expected = RenderPlane(c.color, n_color, d_color);
    const Pose depth_from_color = c.color_from_depth.Inverse();
    int inside = 0;
    for (int y = 0; y < warped.rows; ++y) {
      for (int x = 0; x < warped.cols; ++x) {
        const double z = expected.at<float>(y, x);
        const Eigen::Vector2d u = c.depth.Project(Eigen::Vector3d(
            depth_from_color * Eigen::Vector3d(z * c.color.Unproject(x, y))));
        if (!c.depth.Contains(u, 0.01)) continue;
        ++inside;
        ASSERT_NEAR(warped.at<float>(y, x), z, 1e-5) << x << " " << y;
      }
    }
    EXPECT_GT(inside, warped.rows * warped.cols / 2);
  }
}

// A near square before a far wall: the colour camera sees each of both or
// nothing, never a depth in between (no triangle across the jump), and the near
// one wins where both project.
TEST(WarpDepthToColor, NothingBetweenTwoSurfacesAndTheNearOneWins) {
  const RgbdCalibration c = TwoCameras(2);
  const Eigen::Vector3d z_axis = Eigen::Vector3d::UnitZ();
  cv::Mat depth = RenderPlane(c.depth, z_axis, 3.0);
  depth(cv::Rect(30, 20, 20, 20)).setTo(1.0f);
  const cv::Mat warped = WarpDepthToColor(depth, c);
  int near = 0, far = 0;
  for (int y = 0; y < warped.rows; ++y) {
    for (int x = 0; x < warped.cols; ++x) {
      const float z = warped.at<float>(y, x);
      if (z == 0) continue;
      const bool is_near = std::abs(z - 1) < 0.05;
      EXPECT_TRUE(is_near || std::abs(z - 3) < 0.15) << z;
      ++(is_near ? near : far);
    }
  }
  // The centre of the square, through both cameras.
  const Eigen::Vector3d p =
      c.color_from_depth * Eigen::Vector3d(c.depth.Unproject(39.5, 29.5));
  const Eigen::Vector2d u = c.color.Project(p);
  EXPECT_NEAR(warped.at<float>(static_cast<int>(std::lround(u.y())),
                               static_cast<int>(std::lround(u.x()))),
              p.z(),
              0.01);
  EXPECT_GT(near, 1000);
  EXPECT_GT(far, 10000);
}

// A surface one pixel wide has no triangle but hides what is behind it.
TEST(WarpDepthToColor, ThinSurfacesAreSplatted) {
  const RgbdCalibration c = TwoCameras(1);
  cv::Mat depth = RenderPlane(c.depth, Eigen::Vector3d::UnitZ(), 3.0);
  depth.col(40).setTo(1.0f);
  const cv::Mat warped = WarpDepthToColor(depth, c);
  int near = 0;
  for (int y = 10; y < 50; ++y) {
    for (int x = 0; x < warped.cols; ++x) {
      near += std::abs(warped.at<float>(y, x) - 1) < 0.05;
    }
  }
  EXPECT_GE(near, 35);
}

// One camera: the very same image.
TEST(WarpDepthToColor, OneCameraIsTheIdentity) {
  RgbdCalibration c = TwoCameras(1);
  c.color = c.depth;
  c.color_from_depth = Pose();
  cv::Mat depth = RenderPlane(c.depth, {0.1, 0.2, 1}, 2.0);
  depth.at<float>(7, 9) = 0;
  EXPECT_EQ(cv::norm(WarpDepthToColor(depth, c), depth, cv::NORM_INF), 0);
}

// An almost identical camera gives almost the same image: the general path
// agrees with the shortcut.
TEST(WarpDepthToColor, IsContinuousAtOneCamera) {
  RgbdCalibration c = TwoCameras(1);
  c.color = c.depth;
  c.color_from_depth = Pose();
  c.color_from_depth.translation.x() = 1e-9;
  const cv::Mat depth = RenderPlane(c.depth, {0.1, 0.2, 1}, 2.0);
  EXPECT_LT(cv::norm(WarpDepthToColor(depth, c), depth, cv::NORM_INF), 1e-5);
}

TEST(WarpDepthToColor, NothingStaysNothing) {
  const RgbdCalibration c = TwoCameras(1);
  const cv::Mat nothing = cv::Mat::zeros(60, 80, CV_32F);
  EXPECT_EQ(cv::countNonZero(WarpDepthToColor(nothing, c)), 0);
}

// A picture whose red is the colour camera's column and green its row comes
// back as the projection of each depth pixel; behind the near square a strip
// of the wall is unseen, and what leaves the colour image is unseen.
TEST(RegisterColorToDepth, LooksUpTheProjectionAndKnowsWhatIsHidden) {
  const RgbdCalibration c = TwoCameras(2);
  cv::Mat color(c.color.height, c.color.width, CV_8UC3);
  for (int y = 0; y < color.rows; ++y) {
    for (int x = 0; x < color.cols; ++x) {
      color.at<cv::Vec3b>(y, x) =
          cv::Vec3b(static_cast<uint8_t>(x), static_cast<uint8_t>(y), 9);
    }
  }
  cv::Mat depth = RenderPlane(c.depth, Eigen::Vector3d::UnitZ(), 3.0);
  depth(cv::Rect(30, 20, 20, 20)).setTo(0.6f);
  depth.at<float>(5, 40) = 0;
  const RegisteredColor registered = RegisterColorToDepth(color, depth, c);
  int hidden = 0;
  for (int y = 0; y < depth.rows; ++y) {
    for (int x = 0; x < depth.cols; ++x) {
      const bool seen = registered.seen.at<uint8_t>(y, x) != 0;
      const Eigen::Vector3d p =
          c.color_from_depth *
          Eigen::Vector3d(depth.at<float>(y, x) * c.depth.Unproject(x, y));
      if (p.z() <= 0.1 || !c.color.Contains(c.color.Project(p))) {
        EXPECT_FALSE(seen);
        continue;
      }
      const Eigen::Vector2d u = c.color.Project(p);
      if (seen) {
        EXPECT_NEAR(registered.color.at<cv::Vec3b>(y, x)[0], u.x(), 0.51);
        EXPECT_NEAR(registered.color.at<cv::Vec3b>(y, x)[1], u.y(), 0.51);
      } else {
        ++hidden;
        EXPECT_GT(depth.at<float>(y, x), 1);  // the wall
        EXPECT_TRUE(y >= 15 && y < 45 && x >= 25 && x < 55) << x << " " << y;
      }
    }
  }
  // Baseline 3 cm: the shadow is f b (1/0.6 - 1/3) = 3 px wide, 20 px high.
  EXPECT_GE(hidden, 40);
  EXPECT_LE(hidden, 120);
}

cv::Mat Halves(float left, float right) {
  cv::Mat depth(20, 30, CV_32F, cv::Scalar(left));
  depth(cv::Rect(15, 0, 15, 20)).setTo(right);
  return depth;
}

// Both sides of a jump are marked, nothing else, and dilation adds its radius.
TEST(DepthEdgeMask, MarksBothSidesOfAJump) {
  for (const int dilate : {0, 3}) {
    const cv::Mat mask = DepthEdgeMask(Halves(1, 2), 0.05, 0.03, dilate);
    for (int x = 0; x < 30; ++x) {
      const bool edge = x >= 14 - dilate && x <= 15 + dilate;
      EXPECT_EQ(mask.at<uint8_t>(10, x), edge ? 255 : 0) << x;
    }
  }
  const cv::Mat upright = DepthEdgeMask(Halves(1, 2).t(), 0.05, 0.03, 0);
  EXPECT_EQ(upright.at<uint8_t>(14, 10), 255);
  EXPECT_EQ(upright.at<uint8_t>(13, 10), 0);
}

// Missing beside valid is an edge on either side; missing alone is none.
TEST(DepthEdgeMask, MissingBesideValidIsAnEdge) {
  EXPECT_EQ(cv::countNonZero(DepthEdgeMask(Halves(0, 2), 0.05, 0.03, 0)), 40);
  EXPECT_EQ(cv::countNonZero(DepthEdgeMask(Halves(2, 0), 0.05, 0.03, 0)), 40);
  EXPECT_EQ(cv::countNonZero(DepthEdgeMask(Halves(0, 0), 0.05, 0.03, 0)), 0);
}

// The larger of the absolute and the relative threshold counts.
TEST(DepthEdgeMask, ThresholdGrowsWithDepth) {
  const auto edges = [](float a, float b) {
    return cv::countNonZero(DepthEdgeMask(Halves(a, b), 0.05, 0.03, 0)) > 0;
  };
  EXPECT_TRUE(edges(1, 1.06f));
  EXPECT_FALSE(edges(1, 1.04f));
  EXPECT_FALSE(edges(4, 4.1f));
  EXPECT_TRUE(edges(4, 4.13f));
  EXPECT_TRUE(edges(4.13f, 4));
}

// A z-buffer of two half planes, left and right of the middle of the image:
// 1/z = a + b (x - middle).
cv::Mat TwoPlanes(double a1, double b1, double a2, double b2) {
  cv::Mat depth(20, 60, CV_32F);
  for (int y = 0; y < depth.rows; ++y) {
    for (int x = 0; x < depth.cols; ++x) {
      const double d = x - 29.5;
      depth.at<float>(y, x) =
          static_cast<float>(1 / (d < 0 ? a1 + b1 * d : a2 + b2 * d));
    }
  }
  return depth;
}

// A step of 2 cm between slopes is found although neighbouring pixels of the
// slopes differ by more; the same slopes meeting in a crease are none. Breaks
// if depths are compared without continuing the surfaces, or z instead of 1/z.
TEST(SurfaceEdgeMask, FindsLowStepsAndNoSlopesOrCreases) {
  const double slope = 0.003;  // 1/m a pixel: 1.2 cm a pixel at 2 m
  for (const bool upright : {false, true}) {
    const auto count = [&](const cv::Mat& depth, int dilate) {
      const cv::Mat turned = upright ? cv::Mat(depth.t()) : depth;
      return cv::countNonZero(SurfaceEdgeMask(turned, 0.008, 0.004, dilate));
    };
    EXPECT_EQ(count(TwoPlanes(0.5, slope, 0.5, slope), 3), 0);
    EXPECT_EQ(count(TwoPlanes(0.5, slope, 0.5, -slope), 3), 0);
    const cv::Mat step = TwoPlanes(0.5, slope, 1 / 2.02, slope);
    EXPECT_GE(count(step, 0), 2 * 20);
    EXPECT_LE(count(step, 0), 4 * 20);
    EXPECT_EQ(count(step, 3), count(step, 0) + 6 * 20);
  }
}

// Nothing beside something is an edge, nothing alone is none.
TEST(SurfaceEdgeMask, TheEndOfTheMeshIsAnEdge) {
  EXPECT_GT(cv::countNonZero(SurfaceEdgeMask(Halves(0, 2), 0.008, 0, 0)), 0);
  EXPECT_EQ(cv::countNonZero(SurfaceEdgeMask(Halves(0, 0), 0.008, 0, 0)), 0);
}

TEST(DepthSigma, GrowsFromMillimetresToCentimetres) {
  EXPECT_NEAR(DepthSigma(0.4), 0.0012, 1e-12);
  EXPECT_NEAR(DepthSigma(2.4), 0.0012 + 0.0019 * 4, 1e-12);
}

}  // namespace
}  // namespace facet
