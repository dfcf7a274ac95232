// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "rgbd/keyframes.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/rgbd/tiny_sequence.h"
#include "util/errors.h"
#include "util/parallel_for.h"

namespace facet {
namespace {

std::vector<int> KeyframeNumbers(const TinySequence& files,
                                 const KeyframeOptions& options) {
  const auto sequence = OpenSequence(files.path(), SequenceOptions());
  std::vector<int> numbers;
  for (const int i : SelectKeyframes(*sequence, options)) {
    numbers.push_back(sequence->frames()[i].number);
  }
  return numbers;
}

KeyframeOptions Window(int window) {
  KeyframeOptions options;
  options.window = window;
  return options;
}

// Breaks if windows run over indices instead of frame numbers (gaps!), if the
// blurriest wins, or if ties do not go to the lower number.
TEST(Keyframes, SharpestOfEachWindowOfNumbers) {
  const TinySequence files({0, 1, 4, 7, 8, 21, 22});
  files.WriteTexture(0, 2);
  files.WriteTexture(1, 0);
  files.WriteTexture(4, 1);
  files.WriteTexture(7, 1);
  files.WriteTexture(8, 3);
  files.WriteTexture(21, 1);
  files.WriteTexture(22, 1);
  EXPECT_EQ(KeyframeNumbers(files, Window(5)), (std::vector<int>{1, 7, 21}));
  EXPECT_EQ(KeyframeNumbers(files, Window(1)),
            (std::vector<int>{0, 1, 4, 7, 8, 21, 22}));
  EXPECT_EQ(KeyframeNumbers(files, Window(100)), (std::vector<int>{1}));
}

// A held-out frame is never a keyframe, however sharp.
TEST(Keyframes, HeldOutFramesAreNotUsed) {
  const TinySequence files({0, 1, 2, 3, 4});
  for (int i = 0; i < 5; ++i) files.WriteTexture(i, i == 2 ? 0 : 1 + i);
  KeyframeOptions options = Window(5);
  options.holdout_stride = 5;
  options.holdout_offset = 2;
  EXPECT_EQ(KeyframeNumbers(files, options), (std::vector<int>{0}));
  options.holdout_offset = 7;  // the same class modulo 5
  EXPECT_EQ(KeyframeNumbers(files, options), (std::vector<int>{0}));
  options.holdout_stride = 1;
  EXPECT_THROW(KeyframeNumbers(files, options), UnsolvableError);
}

TEST(Keyframes, HoldoutOffByDefault) {
  for (int number = 0; number < 10; ++number) {
    EXPECT_FALSE(IsHeldOut(number, KeyframeOptions()));
  }
}

// Unusable frames are skipped; blur is NaN exactly where nothing was read.
TEST(Keyframes, UnusableFramesAreSkipped) {
  const TinySequence files({0, 1, 2});
  files.WriteTexture(0, 0);
  files.WriteTexture(1, 1);
  files.WriteTexture(2, 2);
  files.WritePose(0, Eigen::Matrix4d::Zero());
  const auto sequence = OpenSequence(files.path(), SequenceOptions());
  const KeyframeChoice choice = ChooseKeyframes(*sequence, Window(5));
  EXPECT_EQ(choice.tried, 2u);
  EXPECT_EQ(choice.keyframes, (std::vector<int>{1}));
  ASSERT_EQ(choice.blur.size(), 3u);
  EXPECT_TRUE(std::isnan(choice.blur[0]));
  EXPECT_LT(choice.blur[1], choice.blur[2]);
}

// One image in ten that does not decode is skipped, three are an error.
TEST(Keyframes, UndecodableImages) {
  const TinySequence files({0, 1, 2, 3, 4, 5, 6, 7, 8, 9});
  for (int i = 0; i < 10; ++i) files.WriteTexture(i, i == 3 ? 0 : 1);
  files.Truncate(files.FrameFile(3, "color.png"), 0.5);
  EXPECT_EQ(KeyframeNumbers(files, Window(10)), (std::vector<int>{0}));
  files.Truncate(files.FrameFile(5, "color.png"), 0.5);
  files.Truncate(files.FrameFile(6, "color.png"), 0.5);
  EXPECT_THROW(KeyframeNumbers(files, Window(10)), InputError);
}

TEST(Keyframes, SameAtAnyThreadCount) {
  const TinySequence files({0, 1, 2, 3, 4, 5, 6, 7});
  for (int i = 0; i < 8; ++i) files.WriteTexture(i, 0.4 + 0.3 * ((5 * i) % 8));
  const auto sequence = OpenSequence(files.path(), SequenceOptions());
  SetNumThreads(1);
  const KeyframeChoice one = ChooseKeyframes(*sequence, Window(3));
  SetNumThreads(4);
  const KeyframeChoice many = ChooseKeyframes(*sequence, Window(3));
  SetNumThreads(0);
  EXPECT_EQ(one.keyframes, many.keyframes);
  EXPECT_EQ(one.blur, many.blur);
}

TEST(Keyframes, SenselessOptionsAreRefused) {
  const TinySequence files({0});
  EXPECT_THROW(KeyframeNumbers(files, Window(0)), OptionsError);
  KeyframeOptions options;
  options.holdout_stride = -1;
  EXPECT_THROW(KeyframeNumbers(files, options), OptionsError);
}

}  // namespace
}  // namespace facet
