// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "geometry/image_sampler.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "util/random.h"

namespace facet {
namespace {

// 13 x 9 random pixels inside wider rows, whose rest must never be read.
class ImageSamplerTest : public testing::Test {
 protected:
  ImageSamplerTest() : pixels_(9 * 20, std::nanf("")) {
    Random random(1);
    for (int y = 0; y < 9; ++y) {
      for (int x = 0; x < 13; ++x) {
        pixels_[20 * y + x] = static_cast<float>(random.Uniform());
      }
    }
    image_ = {pixels_.data(), 13, 9, 20};
  }

  std::vector<float> pixels_;
  ImageView<float> image_;
};

// Pixel centres are at integers. Breaks by a half-pixel shift, or by a read
// beyond the last row or column.
TEST_F(ImageSamplerTest, PixelCentresGiveThePixels) {
  for (int y = 0; y < 9; ++y) {
    for (int x = 0; x < 13; ++x) {
      const Sample s = SampleBilinear(image_, x, y);
      EXPECT_FLOAT_EQ(static_cast<float>(s.value), image_.At(x, y));
      EXPECT_FALSE(s.clamped);
    }
  }
}

// Within a cell the interpolant is a polynomial: the gradient is the central
// difference up to rounding. Breaks if it is filtered or taken elsewhere.
TEST_F(ImageSamplerTest, GradientIsTheCentralDifference) {
  Random random(2);
  const double h = 1e-3;
  for (int i = 0; i < 200; ++i) {
    // Away from the cell borders, where the gradient jumps.
    const double u =
        static_cast<double>(random.Index(12)) + random.Uniform(0.01, 0.99);
    const double v =
        static_cast<double>(random.Index(8)) + random.Uniform(0.01, 0.99);
    const Sample s = SampleBilinear(image_, u, v);
    const auto value = [&](double x, double y) {
      return SampleBilinear(image_, x, y).value;
    };
    EXPECT_NEAR(s.dx, (value(u + h, v) - value(u - h, v)) / (2 * h), 1e-10);
    EXPECT_NEAR(s.dy, (value(u, v + h) - value(u, v - h)) / (2 * h), 1e-10);
  }
}

// Breaks if samples outside are dropped, extrapolated, or pull the pose by a
// derivative across the border that the clamped function does not have.
TEST_F(ImageSamplerTest, OutsideIsClampedWithoutDerivativeAcross) {
  const Sample inside = SampleBilinear(image_, 0, 3.3);
  const Sample left = SampleBilinear(image_, -2.5, 3.3);
  EXPECT_TRUE(left.clamped);
  EXPECT_DOUBLE_EQ(left.value, inside.value);
  EXPECT_EQ(left.dx, 0);
  EXPECT_DOUBLE_EQ(left.dy, inside.dy);
  const Sample below = SampleBilinear(image_, 4.4, 8.01);
  EXPECT_TRUE(below.clamped);
  EXPECT_EQ(below.dy, 0);
  EXPECT_DOUBLE_EQ(below.dx, SampleBilinear(image_, 4.4, 8).dx);
  const Sample corner = SampleBilinear(image_, 1e9, -1e9);
  EXPECT_TRUE(corner.clamped);
  EXPECT_FLOAT_EQ(static_cast<float>(corner.value), image_.At(12, 0));
}

// A point on the camera plane projects to NaN. Breaks if the index of a pixel
// is computed from it: that reads anywhere in memory.
TEST_F(ImageSamplerTest, NotANumberIsClampedToo) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Sample& s : {SampleBilinear(image_, nan, 3),
                          SampleBilinear(image_, 3, nan),
                          SampleBilinear(image_, nan, nan)}) {
    EXPECT_TRUE(s.clamped);
    EXPECT_TRUE(std::isfinite(s.value));
    EXPECT_TRUE(std::isfinite(s.dx));
    EXPECT_TRUE(std::isfinite(s.dy));
  }
}

// Catmull-Rom passes through the pixels and is a polynomial in each cell.
TEST_F(ImageSamplerTest, BicubicPassesThroughThePixels) {
  for (int y = 0; y < 9; ++y) {
    for (int x = 0; x < 13; ++x) {
      EXPECT_NEAR(SampleBicubic(image_, x, y).value, image_.At(x, y), 1e-6);
    }
  }
}

// Over the whole image, border cells (repeated taps) and pixel borders, where
// bilinear gradients jump. Breaks if a weight and its derivative differ.
TEST_F(ImageSamplerTest, BicubicGradientIsTheCentralDifference) {
  Random random(3);
  const double h = 1e-5;
  for (int i = 0; i < 300; ++i) {
    const double u = random.Uniform(0.01, 11.99),
                 v = random.Uniform(0.01, 7.99);
    const Sample s = SampleBicubic(image_, u, v);
    const auto value = [&](double x, double y) {
      return SampleBicubic(image_, x, y).value;
    };
    EXPECT_NEAR(s.dx, (value(u + h, v) - value(u - h, v)) / (2 * h), 1e-4);
    EXPECT_NEAR(s.dy, (value(u, v + h) - value(u, v - h)) / (2 * h), 1e-4);
    EXPECT_FALSE(s.clamped);
  }
  const Sample outside = SampleBicubic(image_, -3, 20);
  EXPECT_TRUE(outside.clamped);
  EXPECT_EQ(outside.dx, 0);
  EXPECT_EQ(outside.dy, 0);
  EXPECT_NEAR(outside.value, image_.At(0, 8), 1e-6);
}

// The scale 1/32: breaks with the 1/16 that gives gradients twice too large.
TEST(ImageSamplerScharr, IsExactOnRamps) {
  std::vector<float> pixels;
  for (int y = 0; y < 6; ++y) {
    for (int x = 0; x < 8; ++x) {
      pixels.push_back(static_cast<float>(0.25 * x - 0.125 * y));
    }
  }
  const ImageView<float> image = {pixels.data(), 8, 6, 8};
  std::vector<float> dx, dy;
  ScharrGradients(image, &dx, &dy);
  for (int y = 1; y < 5; ++y) {
    for (int x = 1; x < 7; ++x) {
      EXPECT_FLOAT_EQ(dx[8 * y + x], 0.25f);
      EXPECT_FLOAT_EQ(dy[8 * y + x], -0.125f);
    }
  }
}

}  // namespace
}  // namespace facet
