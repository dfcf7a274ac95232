// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "costs/photo_kernel.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "tests/costs/photo_scene.h"

namespace facet {
namespace {

class PhotoKernelTest : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    kernel_ = FindPhotoKernel(GetParam());
    if (!kernel_) {
      GTEST_SKIP() << "this processor has no " << GetParam();
    }
    EXPECT_STREQ(kernel_->name, GetParam());
  }

  const PhotoKernel* kernel_ = nullptr;
};

std::vector<float> Floats(const std::vector<double>& values) {
  return std::vector<float>(values.begin(), values.end());
}

// Against the double sampler on noise: the steepest image there is. A pixel
// position in float is good to 3e-5 px, the gradient reaches 1 per px.
TEST_P(PhotoKernelTest, SamplesLikeTheReference) {
  Random random(1);
  const TestImage image = NoiseImage(&random);
  for (const bool warped : {false, true}) {
    const PhotoScene s = MakePhotoScene(333, &random);
    const std::vector<float> warp = Floats(s.warp);
    PhotoFrame frame = s.Frame(image);
    if (warped) frame.warp = warp.data();
    std::vector<float> intensity(s.ids.size());
    PhotoCounts counts;
    kernel_->sample(frame,
                    s.plane_texels.data(),
                    s.ids.data(),
                    s.ids.size(),
                    intensity.data(),
                    &counts);
    for (size_t i = 0; i < s.ids.size(); ++i) {
      Eigen::Vector2d u = s.PixelOf(i);
      if (warped) u = s.lattice.Apply(s.warp.data(), u);
      EXPECT_NEAR(
          intensity[i], SampleBilinear(image.view(), u.x(), u.y()).value, 1e-4);
    }
    EXPECT_EQ(counts.used, s.ids.size());
    EXPECT_EQ(counts.clamped, 0u);
    EXPECT_EQ(counts.behind, 0u);
  }
}

// Colours are those of the double sampler, channel by channel, also at the last
// pixel, behind which the buffer ends (asan), and (u, v) is the warped pixel.
TEST_P(PhotoKernelTest, ColoursAreThoseOfTheReference) {
  Random random(9);
  PhotoScene s = MakePhotoScene(333, &random);
  TestImage channels[3];
  std::vector<uint8_t> rgb;
  for (int i = 0; i < s.camera.width * s.camera.height; ++i) {
    for (TestImage& channel : channels) {
      rgb.push_back(static_cast<uint8_t>(random.Index(256)));
      channel.pixels.push_back(rgb.back());
      channel.width = s.camera.width;
      channel.height = s.camera.height;
    }
  }
  rgb.shrink_to_fit();
  const std::vector<float> warp = Floats(s.warp);
  PhotoFrame frame = s.Frame(channels[0]);
  frame.warp = warp.data();
  const size_t n = s.ids.size();
  std::vector<float> out(5 * n);
  float* at = out.data();
  kernel_->sample_rgb(frame,
                      rgb.data(),
                      3 * frame.width,
                      s.plane_texels.data(),
                      s.ids.data(),
                      n,
                      {at, at + n, at + 2 * n, at + 3 * n, at + 4 * n});
  for (size_t i = 0; i < n; ++i) {
    const Eigen::Vector2d u = s.lattice.Apply(s.warp.data(), s.PixelOf(i));
    EXPECT_NEAR(out[i], u.x(), 1e-3);
    EXPECT_NEAR(out[n + i], u.y(), 1e-3);
    for (size_t k = 0; k < 3; ++k) {
      EXPECT_NEAR(out[(2 + k) * n + i],
                  SampleBilinear(channels[k].view(), u.x(), u.y()).value,
                  0.05);
    }
  }
  // The lower right corner and beyond.
  s.pose = {0, 0, 0, 1, 0, 0, 0};
  s.origin.setZero();
  const Eigen::Vector3f x = (2 * s.camera.Unproject(170, 130)).cast<float>();
  const PhotoTexel corner = {x.x(), x.y(), x.z(), 0};
  const uint32_t id = 0;
  float pixel[5];
  kernel_->sample_rgb(s.Frame(channels[0]),
                      rgb.data(),
                      3 * frame.width,
                      &corner,
                      &id,
                      1,
                      {pixel, pixel + 1, pixel + 2, pixel + 3, pixel + 4});
  EXPECT_NEAR(pixel[0], 170, 1e-3);
  for (size_t k = 0; k < 3; ++k)
    EXPECT_EQ(pixel[2 + k], rgb[rgb.size() - 3 + k]);
}

// Points outside the image read its border and are counted, points behind the
// camera too; none is dropped. Breaks if the padding of a chunk is counted.
TEST_P(PhotoKernelTest, CountsWhatIsOutsideOrBehind) {
  Random random(2);
  const TestImage image = NoiseImage(&random);
  PhotoScene s = MakePhotoScene(1, &random);
  s.pose = {0, 0, 0, 1, 0, 0, 0};
  s.origin.setZero();
  const auto at = [&](double u, double v, double z) {
    const Eigen::Vector3f x = (z * s.camera.Unproject(u, v)).cast<float>();
    return PhotoTexel{x.x(), x.y(), x.z(), 0};
  };
  const std::vector<PhotoTexel> texels = {at(50, 60, 2),
                                          at(-7, 60, 2),
                                          at(50, 200, 2),
                                          at(300, -50, 2),
                                          at(80, 60, -2)};
  const std::vector<uint32_t> ids = {0, 1, 2, 3, 4};
  std::vector<float> intensity(5);
  PhotoCounts counts;
  kernel_->sample(
      s.Frame(image), texels.data(), ids.data(), 4, intensity.data(), &counts);
  EXPECT_EQ(counts.clamped, 3u);
  EXPECT_EQ(counts.behind, 0u);
  EXPECT_NEAR(intensity[1], SampleBilinear(image.view(), 0, 60).value, 1e-4);
  EXPECT_NEAR(intensity[2], SampleBilinear(image.view(), 50, 119).value, 1e-4);
  EXPECT_FLOAT_EQ(intensity[3], image.view().At(159, 0));
  kernel_->sample(s.Frame(image),
                  texels.data(),
                  ids.data() + 4,
                  1,
                  intensity.data(),
                  &counts);
  EXPECT_EQ(counts.behind, 1u);
  EXPECT_EQ(counts.used, 5u);
}

// Infinite coordinates must not read outside of the image (NaN, see the design
// notes on compiler flags). Breaks under -ffast-math.
TEST_P(PhotoKernelTest, SurvivesNotANumber) {
  Random random(3);
  const TestImage image = NoiseImage(&random);
  PhotoScene s = MakePhotoScene(70, &random);
  s.plane_texels[3].x = std::nanf("");
  s.plane_texels[66].z = INFINITY;
  std::vector<float> intensity(70);
  PhotoCounts counts;
  kernel_->sample(s.Frame(image),
                  s.plane_texels.data(),
                  s.ids.data(),
                  70,
                  intensity.data(),
                  &counts);
  EXPECT_GE(counts.clamped, 1u);
  for (size_t i = 0; i < 70; ++i) {
    if (i == 3 || i == 66) continue;
    EXPECT_TRUE(std::isfinite(intensity[i])) << i;
  }
}

// Intensity and its derivative when the surface point moves in the plane.
// Breaks if R, the warp's D or an axis is mixed up. Reference: central
// differences in double on an exactly bilinear image.
TEST_P(PhotoKernelTest, SampleGradientIsTheDerivativeInThePlane) {
  Random random(5);
  const TestImage image = BilinearImage(&random);
  const PhotoScene s = MakePhotoScene(90, &random);
  const std::vector<float> warp = Floats(s.warp);
  PhotoFrame frame = s.Frame(image);
  frame.warp = warp.data();
  const Eigen::Vector3d normal(s.plane[0], s.plane[1], s.plane[2]);
  Eigen::Vector3d axis[2];
  axis[0] = normal.unitOrthogonal();
  axis[1] = normal.cross(axis[0]);
  const Eigen::Vector3f e1 = axis[0].cast<float>(), e2 = axis[1].cast<float>();
  std::vector<float> intensity(90), sampled(90), g[2];
  g[0].resize(90);
  g[1].resize(90);
  PhotoCounts counts;
  kernel_->sample_gradient(frame,
                           e1.data(),
                           e2.data(),
                           s.plane_texels.data(),
                           s.ids.data(),
                           90,
                           intensity.data(),
                           g[0].data(),
                           g[1].data(),
                           &counts);
  kernel_->sample(
      frame, s.plane_texels.data(), s.ids.data(), 90, sampled.data(), &counts);
  const Pose cam_from_world = PoseFromBlock(s.pose.data());
  for (size_t i = 0; i < 90; ++i) {
    EXPECT_NEAR(intensity[i], sampled[i], 1e-6);
    const Eigen::Vector3d q =
        ProjectOntoPlane(s.plane.data(), s.p[i], s.anchor);
    const auto value = [&](const Eigen::Vector3d& x) {
      const Eigen::Vector2d u = s.lattice.Apply(
          s.warp.data(), s.camera.Project<double>(cam_from_world * x));
      return SampleBilinear(image.view(), u.x(), u.y()).value;
    };
    for (int k = 0; k < 2; ++k) {
      const double h = 1e-6;
      const double expected =
          (value(q + h * axis[k]) - value(q - h * axis[k])) / (2 * h);
      EXPECT_NEAR(g[k][i], expected, 1e-4) << i;
    }
  }
}

// A smooth image, with gradients that the samplings see differently.
TestImage WavyImage() {
  TestImage image;
  image.width = 160;
  image.height = 120;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      image.pixels.push_back(
          static_cast<float>(0.5 + 0.2 * std::cos(0.31 * x + 0.17 * y) +
                             0.2 * std::sin(0.23 * y - 0.11 * x)));
    }
  }
  return image;
}

// Values and gradients of the other samplings, at points inside, on the border
// cells (bicubic taps repeat the border) and outside, against the double
// versions. The camera looks straight at a plane with 1 m a pixel or so, so
// that the in-plane gradient is that of the image.
TEST_P(PhotoKernelTest, AllSamplingsAgreeWithTheReference) {
  Random random(6);
  const TestImage image = WavyImage();
  PhotoScene s = MakePhotoScene(1, &random);
  s.pose = {0, 0, 0, 1, 0, 0, 0};
  s.origin.setZero();
  const double z = 2;
  std::vector<PhotoTexel> texels;
  std::vector<uint32_t> ids;
  std::vector<Eigen::Vector2d> pixels;
  for (int i = 0; i < 200; ++i) {
    pixels.emplace_back(random.Uniform(-4, 163), random.Uniform(-4, 123));
    const Eigen::Vector3d x =
        z * s.camera.Unproject(pixels.back().x(), pixels.back().y());
    texels.push_back({static_cast<float>(x.x()),
                      static_cast<float>(x.y()),
                      static_cast<float>(x.z()),
                      0});
    ids.push_back(static_cast<uint32_t>(i));
  }
  SampledImage sampled(image.view());
  std::vector<float> dx, dy;
  ScharrGradients(image.view(), &dx, &dy);
  sampled.gradient_x = sampled.gradient_y = sampled.image;
  sampled.gradient_x.data = dx.data();
  sampled.gradient_y.data = dy.data();
  const float e1[3] = {1, 0, 0}, e2[3] = {0, 1, 0};
  for (const Sampling sampling :
       {Sampling::kBilinear, Sampling::kScharr, Sampling::kBicubic}) {
    sampled.sampling = sampling;
    PhotoFrame frame = s.Frame(image);
    frame.sampling = sampling;
    frame.gradient_x = dx.data();
    frame.gradient_y = dy.data();
    std::vector<float> intensity(200), g1(200), g2(200);
    for (const OutOfImage out : {OutOfImage::kFreeze, OutOfImage::kDrop}) {
      frame.out_of_image = out;
      PhotoCounts counts;
      kernel_->sample_gradient(frame,
                               e1,
                               e2,
                               texels.data(),
                               ids.data(),
                               200,
                               intensity.data(),
                               g1.data(),
                               g2.data(),
                               &counts);
      size_t outside = 0;
      for (size_t i = 0; i < 200; ++i) {
        const Sample expected = SampleAt(sampled, pixels[i].x(), pixels[i].y());
        outside += expected.clamped ? 1 : 0;
        if (out == OutOfImage::kDrop && expected.clamped) {
          EXPECT_TRUE(std::isnan(intensity[i]));
          EXPECT_EQ(g1[i], 0);
          EXPECT_EQ(g2[i], 0);
          continue;
        }
        EXPECT_NEAR(intensity[i], expected.value, 2e-5);
        EXPECT_NEAR(g1[i], expected.dx * s.camera.fx / z, 5e-3);
        EXPECT_NEAR(g2[i], expected.dy * s.camera.fy / z, 5e-3);
      }
      EXPECT_EQ(counts.clamped, outside);
      EXPECT_EQ(counts.lost, out == OutOfImage::kDrop ? outside : 0);
      EXPECT_GT(outside, 5u);
    }
  }
}

// All kernels compute the same up to float rounding. Breaks if a vectoriser or
// a flag changes a select.
TEST_P(PhotoKernelTest, AgreesWithTheBaseline) {
  const PhotoKernel* baseline = FindPhotoKernel("baseline");
  ASSERT_NE(baseline, nullptr);
  Random random(4);
  const TestImage image = BilinearImage(&random);
  const PhotoScene s = MakePhotoScene(500, &random);
  const std::vector<float> warp = Floats(s.warp);
  PhotoFrame frame = s.Frame(image);
  frame.warp = warp.data();
  const float plane[4] = {static_cast<float>(s.plane[0]),
                          static_cast<float>(s.plane[1]),
                          static_cast<float>(s.plane[2]),
                          static_cast<float>(s.plane[3])};
  const Eigen::Vector3f anchor = (s.anchor - s.origin).cast<float>();
  double cell_gram[2][GramSize(14)] = {}, plane_gram[2][GramSize(4)] = {};
  double cell_cost[2], plane_cost[2];
  std::vector<float> intensity[2];
  const PhotoKernel* kernels[2] = {kernel_, baseline};
  for (int k = 0; k < 2; ++k) {
    PhotoCounts counts;
    intensity[k].resize(s.ids.size());
    kernels[k]->sample(frame,
                       s.plane_texels.data(),
                       s.ids.data(),
                       s.ids.size(),
                       intensity[k].data(),
                       &counts);
    const PhotoFrame cell = [&] {
      PhotoFrame f = frame;
      f.warp = warp.data();  // read as the four vertices of one cell
      return f;
    }();
    cell_cost[k] = kernels[k]->frame_cell(cell,
                                          2,
                                          1,
                                          s.plane_texels.data(),
                                          s.ids.data(),
                                          s.ids.size(),
                                          true,
                                          cell_gram[k],
                                          &counts);
    plane_cost[k] = kernels[k]->plane_segment(frame,
                                              plane,
                                              anchor.data(),
                                              s.mesh_texels.data(),
                                              s.ids.data(),
                                              s.ids.size(),
                                              plane_gram[k],
                                              &counts);
    EXPECT_EQ(counts.used, 3 * s.ids.size());
    EXPECT_EQ(counts.behind, 0u);
  }
  for (size_t i = 0; i < s.ids.size(); ++i) {
    EXPECT_NEAR(intensity[0][i], intensity[1][i], 2e-6);
  }
  const auto expect_same = [](const double* a, const double* b, int n) {
    for (int i = 0; i < n; ++i) {
      for (int j = i; j < n; ++j) {
        EXPECT_NEAR(a[i * n + j],
                    b[i * n + j],
                    1e-4 * std::sqrt(b[i * n + i] * b[j * n + j]));
      }
    }
  };
  expect_same(cell_gram[0], cell_gram[1], 15);
  expect_same(plane_gram[0], plane_gram[1], 5);
  EXPECT_NEAR(cell_cost[0], cell_cost[1], 1e-4 * cell_cost[1]);
  EXPECT_NEAR(plane_cost[0], plane_cost[1], 1e-4 * plane_cost[1]);
}

INSTANTIATE_TEST_SUITE_P(Kernels,
                         PhotoKernelTest,
                         testing::ValuesIn(kPhotoKernelNames),
                         [](const auto& param_info) {
                           return std::string(param_info.param);
                         });

// Breaks if a misspelt wish silently gives the slow kernel.
TEST(FindPhotoKernel, UnknownNamesGiveNothing) {
  EXPECT_EQ(FindPhotoKernel("avx1024"), nullptr);
  EXPECT_EQ(FindPhotoKernel(""), nullptr);
  EXPECT_NE(FindPhotoKernel(GetPhotoKernel().name), nullptr);
}

}  // namespace
}  // namespace facet
