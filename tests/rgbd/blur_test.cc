// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "rgbd/blur.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

namespace facet {
namespace {

cv::Mat Noise(int width, int height) {
  cv::Mat image(height, width, CV_32F);
  cv::RNG random(3);
  random.fill(image, cv::RNG::UNIFORM, 0.0, 1.0);
  return image;
}

double Blur(const cv::Mat& image) {
  return CreteBlur({image.ptr<float>(),
                    image.cols,
                    image.rows,
                    static_cast<ptrdiff_t>(image.step1())});
}

// The definition, spelled out with a mirrored border and a real box blur.
double BlurByDefinition(const cv::Mat& f) {
  double blur[2];
  for (int axis = 0; axis < 2; ++axis) {
    cv::Mat image, box;
    f.convertTo(image, CV_64F);
    cv::blur(image,
             box,
             axis == 0 ? cv::Size(9, 1) : cv::Size(1, 9),
             {-1, -1},
             cv::BORDER_REFLECT);
    double s_f = 0, s_v = 0;
    for (int i = 1; i < f.rows; ++i) {
      for (int j = 1; j < f.cols; ++j) {
        const int di = axis == 1, dj = axis == 0;
        const double d_f =
            std::abs(image.at<double>(i, j) - image.at<double>(i - di, j - dj));
        const double d_b =
            std::abs(box.at<double>(i, j) - box.at<double>(i - di, j - dj));
        s_f += d_f;
        s_v += std::max(0.0, d_f - d_b);
      }
    }
    blur[axis] = (s_f - s_v) / s_f;
  }
  return std::max(blur[0], blur[1]);
}

// Breaks if the shortcut for the difference of box means is off by a tap or
// treats the border otherwise; sizes include some smaller than the box.
TEST(CreteBlur, EqualsItsDefinition) {
  for (const cv::Size size : {cv::Size(64, 48),
                              cv::Size(9, 31),
                              cv::Size(10, 10),
                              cv::Size(200, 6)}) {
    const cv::Mat image = Noise(size.width, size.height);
    EXPECT_NEAR(Blur(image), BlurByDefinition(image), 1e-5) << size;
  }
}

// The point of the metric: more Gaussian blur, higher value.
TEST(CreteBlur, GrowsWithGaussianBlur) {
  const cv::Mat image = Noise(120, 90);
  double last = Blur(image);
  EXPECT_LT(last, 0.3);
  for (const double sigma : {0.5, 1.0, 2.0, 4.0, 8.0}) {
    cv::Mat blurred;
    cv::GaussianBlur(image, blurred, {0, 0}, sigma);
    const double blur = Blur(blurred);
    EXPECT_GT(blur, last) << sigma;
    EXPECT_LE(blur, 1.0);
    last = blur;
  }
}

// Motion blur along one axis alone counts: the larger of both directions.
TEST(CreteBlur, SeesBlurAlongEitherAxis) {
  const cv::Mat image = Noise(120, 90);
  for (const cv::Size kernel : {cv::Size(25, 1), cv::Size(1, 25)}) {
    cv::Mat blurred;
    cv::GaussianBlur(image, blurred, kernel, 4);
    EXPECT_GT(Blur(blurred), Blur(image) + 0.3);
  }
}

// Gain and offset of the exposure do not count.
TEST(CreteBlur, DoesNotDependOnGainAndOffset) {
  const cv::Mat image = Noise(64, 48);
  const cv::Mat other = 0.25 * image + 0.5;
  EXPECT_NEAR(Blur(other), Blur(image), 1e-5);
}

TEST(CreteBlur, ConstantAndTinyImagesAreOne) {
  EXPECT_EQ(Blur(cv::Mat(20, 30, CV_32F, cv::Scalar(0.3))), 1.0);
  EXPECT_EQ(Blur(Noise(1, 1)), 1.0);
  EXPECT_EQ(Blur(Noise(1, 5)), 1.0);
}

// The view's stride is respected: a crop equals its copy.
TEST(CreteBlur, RespectsTheStride) {
  const cv::Mat image = Noise(64, 48);
  const cv::Mat crop = image(cv::Rect(5, 7, 30, 20));
  EXPECT_EQ(Blur(crop), Blur(crop.clone()));
}

}  // namespace
}  // namespace facet
