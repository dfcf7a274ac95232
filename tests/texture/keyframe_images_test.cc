// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "texture/keyframe_images.h"

#include <gtest/gtest.h>

#include "geometry/pinhole.h"

namespace facet {
namespace {

// A ramp keeps its value at the same ray in every level, to the bit of a mean.
// Breaks if the pyramid and Pinhole::Level disagree about where pixel centres
// lie (half a pixel off moves all poses), also for sizes that do not divide.
TEST(PyramidLevel, IsSeenByTheCameraOfThatLevel) {
  Pinhole camera{60, 61, 20.3, 14.8, 45, 34};
  KeyframeImages images;
  images.luma.emplace_back(camera.height, camera.width, CV_32F);
  images.rgb.emplace_back(camera.height, camera.width, CV_8UC3, cv::Scalar(7));
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const Eigen::Vector3d ray = camera.Unproject(x, y);
      images.luma[0].at<float>(y, x) =
          static_cast<float>(0.5 + 0.3 * ray.x() + 0.2 * ray.y());
    }
  }
  for (const int level : {1, 2, 3}) {
    const Pinhole coarse = camera.Level(level);
    const KeyframeImages reduced = PyramidLevel(images, level, 0);
    ASSERT_EQ(reduced.luma.size(), 1u);
    const cv::Mat& luma = reduced.luma[0];
    ASSERT_EQ(luma.cols, coarse.width);
    ASSERT_EQ(luma.rows, coarse.height);
    EXPECT_EQ(reduced.rgb[0].size(), luma.size());
    for (int y = 0; y < luma.rows; ++y) {
      for (int x = 0; x < luma.cols; ++x) {
        const Eigen::Vector3d ray = coarse.Unproject(x, y);
        EXPECT_NEAR(
            luma.at<float>(y, x), 0.5 + 0.3 * ray.x() + 0.2 * ray.y(), 1e-5);
      }
    }
  }
}

}  // namespace
}  // namespace facet
