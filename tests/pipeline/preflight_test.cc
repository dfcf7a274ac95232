// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "pipeline/preflight.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "util/errors.h"
#include "util/resources.h"
#include "util/warnings.h"

namespace facet {
namespace {

using ::testing::HasSubstr;

SceneSize Room() { return {765221, 26, 200, 640 * 480}; }

double Peak(const ReconstructOptions& options, const SceneSize& size) {
  return EstimateMemory(options, size).PeakMb();
}

MemoryEstimate Streamed(const ReconstructOptions& options,
                        const SceneSize& size) {
  return EstimateMemory(options, size, ImagePlace::kFile);
}

// Whatever makes a run larger makes the estimate larger, never smaller.
TEST(MemoryEstimate, GrowsWithTheScene) {
  const ReconstructOptions options;
  const double room = Peak(options, Room());
  SceneSize size = Room();
  size.faces *= 20;
  EXPECT_GT(Peak(options, size), room);
  size = Room();
  size.area_m2 *= 4;
  EXPECT_GT(Peak(options, size), room);
  size = Room();
  size.keyframes *= 3;
  EXPECT_GT(Peak(options, size), room);
  size = Room();
  size.image_pixels *= 4;
  EXPECT_GT(Peak(options, size), room);
}

TEST(MemoryEstimate, FollowsTheOptions) {
  const ReconstructOptions options;
  const MemoryEstimate room = EstimateMemory(options, Room());
  ReconstructOptions o = options;
  o.atlas.texel_size_m /= 2;
  EXPECT_GT(EstimateMemory(o, Room()).export_mb, room.export_mb);
  o = options;
  o.photometric.max_observations *= 4;
  EXPECT_GT(EstimateMemory(o, Room()).photometric_mb, room.photometric_mb);
  o = options;
  o.photometric.stride = 1;
  const double dense = EstimateMemory(o, Room()).photometric_mb;
  EXPECT_GT(dense, room.photometric_mb);
  o.photometric.stride = 4;
  EXPECT_LT(EstimateMemory(o, Room()).photometric_mb, dense);
  o = options;
  o.photometric.smoothing_sigma_px = 0;
  EXPECT_LT(EstimateMemory(o, Room()).photometric_mb, room.photometric_mb);
}

// Breaks if a budget changes what it does not have to, promises what the
// estimate denies, or lets a run start that does not fit.
TEST(FitIntoMemory, UsesAFileOnlyIfItMustAndRefusesTheRest) {
  ReconstructOptions options;
  options.atlas.texel_size_m = 0.01;  // images decide
  const auto place_within = [&](double limit_mb) {
    options.max_memory_gb = limit_mb / 1024;
    return FitIntoMemory(options, Room());
  };
  const double full = Peak(options, Room());
  const double least = Streamed(options, Room()).PeakMb();
  EXPECT_LT(least, full);
  EXPECT_EQ(place_within(0), ImagePlace::kMemory);
  EXPECT_EQ(place_within(full + 1), ImagePlace::kMemory);
  EXPECT_EQ(place_within(full - 1), ImagePlace::kFile);
  EXPECT_EQ(place_within(least + 1), ImagePlace::kFile);
  EXPECT_THROW(place_within(least - 1), OptionsError);
}

// What a file saves are the images: without them keyframes cost no more than
// what a tile of the texture sees of them. Breaks if phases that read all of
// them at once are promised to do without.
TEST(FitIntoMemory, AFileHoldsTheImages) {
  ReconstructOptions options;
  SceneSize many = Room();
  many.keyframes *= 3;
  options.photometric.stride = 32;  // observations do not decide
  const MemoryEstimate in_memory = EstimateMemory(options, many);
  const MemoryEstimate in_file = Streamed(options, many);
  EXPECT_LT(in_file.PeakMb(), in_memory.PeakMb() / 2);
  EXPECT_EQ(in_memory.file_mb, 0);
  EXPECT_GT(in_file.file_mb, in_memory.PeakMb() / 2);
  EXPECT_THAT(DescribePlan(many, in_file, 0), HasSubstr("in a scratch file"));
  options.photometric.schedule = "10x[C; Phi; T+F]";
  EXPECT_GT(Streamed(options, many).photometric_mb,
            in_file.photometric_mb + 500);
}

// Nothing overflows and nothing is negative at the ends of the range.
TEST(MemoryEstimate, IsFiniteAndPositive) {
  ReconstructOptions options;
  for (const int stride : {0, 1, 1000}) {
    options.photometric.stride = stride;
    for (const SceneSize& size :
         {SceneSize(),
          SceneSize{1, 1e-6, 1, 1},
          SceneSize{size_t{1} << 31, 1e5, size_t{1} << 20, size_t{1} << 26}}) {
      EXPECT_GT(Peak(options, size), 0);
      EXPECT_LT(Peak(options, size), 1e12);
    }
  }
}

// A scan too large for the machine is told at once, with what to do.
TEST(MemoryEstimate, WarnsOfTooLittleMemory) {
  const MemoryEstimate estimate = EstimateMemory({}, Room());
  const size_t warnings = Warnings().size();
  DescribePlan(Room(), estimate, 0);
  DescribePlan(Room(), estimate, estimate.PeakMb() + 1);
  EXPECT_EQ(Warnings().size(), warnings);
  const std::string plan = DescribePlan(Room(), estimate, 100);
  EXPECT_THAT(plan, HasSubstr("765221 faces"));
  ASSERT_EQ(Warnings().size(), warnings + 1);
  EXPECT_THAT(Warnings().back(), HasSubstr("only 100 MB"));
  EXPECT_THAT(Warnings().back(), HasSubstr("--max_observations"));
}

TEST(MemoryEstimate, AvailableMemoryIsPlausible) {
  const double available = AvailableMemoryMb();
  EXPECT_GE(available, 0);
  EXPECT_LT(available, 1e9);
}

}  // namespace
}  // namespace facet
