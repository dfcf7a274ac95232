// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "texture/keyframe_images.h"

#include <gtest/gtest.h>

#include "geometry/pinhole.h"

namespace facet {
namespace {

// A ramp keeps its value at the same ray in every level, but for 8 bits.
// Breaks if the pyramid and Pinhole::Level disagree about where pixel centres
// lie (half a pixel off moves all poses), also for sizes that do not divide.
TEST(PyramidLevel, IsSeenByTheCameraOfThatLevel) {
  Pinhole camera{60, 61, 20.3, 14.8, 45, 34};
  KeyframeImages images;
  images.rgb.emplace_back(camera.height, camera.width, CV_8UC3);
  const auto ramp = [](const Eigen::Vector3d& ray) {
    return 0.5 + 0.8 * ray.x() + 0.5 * ray.y();
  };
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const Eigen::Vector3d ray = camera.Unproject(x, y);
      images.rgb[0].at<cv::Vec3b>(y, x) =
          cv::Vec3b::all(cv::saturate_cast<uint8_t>(255 * ramp(ray)));
    }
  }
  for (const int level : {1, 2, 3}) {
    const Pinhole coarse = camera.Level(level);
    const KeyframeImages reduced = PyramidLevel(images, level, 0);
    ASSERT_EQ(reduced.smooth.size(), 1u);
    const cv::Mat& luma = reduced.smooth[0];
    ASSERT_EQ(luma.cols, coarse.width);
    ASSERT_EQ(luma.rows, coarse.height);
    EXPECT_EQ(reduced.rgb[0].size(), luma.size());
    for (int y = 0; y < luma.rows; ++y) {
      for (int x = 0; x < luma.cols; ++x) {
        const Eigen::Vector3d ray = coarse.Unproject(x, y);
        EXPECT_NEAR(luma.at<float>(y, x), ramp(ray), 0.5 / 255 + 1e-4);
      }
    }
  }
}

}  // namespace
}  // namespace facet
