// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The images of a sequence: what is decoded, and what is refused.
#include <gtest/gtest.h>

#include <filesystem>

#include "rgbd/sequence.h"
#include "tests/rgbd/tiny_sequence.h"
#include "util/errors.h"

namespace facet {
namespace {

std::unique_ptr<RgbdSequence> Open(const TinySequence& files) {
  return OpenSequence(files.path(), SequenceOptions());
}

// Breaks if channels come as BGR.
TEST(Sequence, ColorIsRgb) {
  const TinySequence files;
  const cv::Mat color = Open(files)->LoadColor(0);
  ASSERT_EQ(color.type(), CV_8UC3);
  const cv::Vec3b pixel = color.at<cv::Vec3b>(15, 20);
  EXPECT_NEAR(pixel[0], 200, 3);
  EXPECT_NEAR(pixel[1], 60, 3);
  EXPECT_NEAR(pixel[2], 10, 3);
}

// The luma that is decoded without the colours is that of the colours, to the
// rounding of 8 bits. Breaks if another channel is taken for it.
TEST(Sequence, LumaIsThatOfTheColours) {
  const TinySequence files;
  const auto sequence = Open(files);
  const cv::Mat luma = sequence->LoadLuma(0);
  ASSERT_EQ(luma.type(), CV_32F);
  EXPECT_LT(cv::norm(luma, LumaFromRgb(sequence->LoadColor(0)), cv::NORM_INF),
            2.5 / 255);
}

// A depth image that is kept is read once: its file may be gone. Breaks if the
// range is applied to what is kept, or nothing is kept.
TEST(Sequence, KeptDepthIsReadOnce) {
  for (const bool keep : {true, false}) {
    const TinySequence files;
    SequenceOptions options;
    options.keep_depth = keep;
    const auto sequence = OpenSequence(files.path(), options);
    const cv::Mat first = sequence->LoadDepth(0);
    std::filesystem::remove(sequence->frames()[0].depth_path);
    if (keep) {
      EXPECT_EQ(cv::norm(first, sequence->LoadDepth(0), cv::NORM_INF), 0);
      EXPECT_GE(cv::countNonZero(sequence->LoadDepthOfAnyRange(0)),
                cv::countNonZero(first));
    } else {
      EXPECT_THROW(sequence->LoadDepth(0), InputError);
    }
  }
}

// 0, 65535 and values outside the range are missing; the range's ends are not.
TEST(Sequence, DepthIsMetresAndMissingIsZero) {
  const TinySequence files;
  cv::Mat raw(24, 32, CV_16U, cv::Scalar(2000));
  const uint16_t values[] = {0, 65535, 299, 300, 6000, 6001};
  for (int i = 0; i < 6; ++i) raw.at<uint16_t>(3, i) = values[i];
  cv::imwrite(files.FrameFile(1, "depth.png"), raw);
  const cv::Mat depth = Open(files)->LoadDepth(1);
  ASSERT_EQ(depth.type(), CV_32F);
  const float expected[] = {0, 0, 0, 0.3f, 6.0f, 0};
  for (int i = 0; i < 6; ++i) {
    EXPECT_FLOAT_EQ(depth.at<float>(3, i), expected[i]);
  }
  EXPECT_FLOAT_EQ(depth.at<float>(10, 10), 2.0f);

  const cv::Mat any = Open(files)->LoadDepthOfAnyRange(1);
  const float expected_any[] = {0, 0, 0.299f, 0.3f, 6.0f, 6.001f};
  for (int i = 0; i < 6; ++i) {
    EXPECT_FLOAT_EQ(any.at<float>(3, i), expected_any[i]);
  }
}

// Breaks if the big-endian samples of a 16-bit PGM are taken as they lie.
TEST(Sequence, ReadsPgmDepthAndPngColor) {
  const TinySequence files;
  files.Remove(files.FrameFile(0, "depth.png"));
  files.Remove(files.FrameFile(0, "color.jpg"));
  cv::imwrite(files.FrameFile(0, "color.png"),
              cv::Mat(30, 40, CV_8UC3, cv::Scalar(1, 2, 3)));
  std::string pgm = "P5\n32 24\n65535\n";
  for (int i = 0; i < 32 * 24; ++i) pgm += std::string("\x04\x01", 2);
  files.Write("frame-000000.depth.pgm", pgm);
  const auto sequence = Open(files);
  EXPECT_FLOAT_EQ(sequence->LoadDepth(0).at<float>(5, 5), 1.025f);
  EXPECT_EQ(sequence->LoadColor(0).at<cv::Vec3b>(5, 5), cv::Vec3b(3, 2, 1));
}

// A later frame of another size is found when it is loaded.
TEST(Sequence, ALaterFrameOfAnotherSizeFailsOnLoad) {
  const TinySequence files;
  cv::imwrite(files.FrameFile(2, "color.jpg"),
              cv::Mat(60, 80, CV_8UC3, cv::Scalar(0, 0, 0)));
  EXPECT_THROW(Open(files)->LoadColor(2), InputError);
}

// Truncated, empty, foreign and missing images; libjpeg alone would return the
// truncated one half grey.
TEST(Sequence, ImagesThatDoNotDecodeFailOnLoad) {
  const TinySequence files;
  const auto sequence = Open(files);
  const std::string color = files.FrameFile(1, "color.jpg");
  const std::string depth = files.FrameFile(1, "depth.png");
  for (const double share : {0.7, 0.3, 0.0}) {
    files.WriteFrame(1);
    files.Truncate(color, share);
    files.Truncate(depth, share);
    EXPECT_THROW(sequence->LoadColor(1), InputError) << share;
    EXPECT_THROW(sequence->LoadDepth(1), InputError) << share;
  }
  files.Write("frame-000001.color.jpg", "this is text");
  EXPECT_THROW(sequence->LoadColor(1), InputError);
  files.Remove(color);
  EXPECT_THROW(sequence->LoadColor(1), InputError);
}

// The weights sum to 1 and each channel has its own.
TEST(Luma, WeighsTheChannels) {
  cv::Mat rgb(1, 4, CV_8UC3);
  rgb.at<cv::Vec3b>(0, 0) = {255, 255, 255};
  rgb.at<cv::Vec3b>(0, 1) = {255, 0, 0};
  rgb.at<cv::Vec3b>(0, 2) = {0, 255, 0};
  rgb.at<cv::Vec3b>(0, 3) = {0, 0, 255};
  const cv::Mat luma = LumaFromRgb(rgb);
  EXPECT_NEAR(luma.at<float>(0, 0), 1, 1e-6);
  EXPECT_NEAR(luma.at<float>(0, 1), 0.299, 1e-6);
  EXPECT_NEAR(luma.at<float>(0, 2), 0.587, 1e-6);
  EXPECT_NEAR(luma.at<float>(0, 3), 0.114, 1e-6);
}

}  // namespace
}  // namespace facet
