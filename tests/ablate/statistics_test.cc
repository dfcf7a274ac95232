// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "ablate/statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "util/random.h"

namespace facet {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

TEST(Statistics, MeanAndSpread) {
  const SampleStatistics sample = StatisticsOf({2, 4, kNone, 4, 4, 5, 5, 7, 9});
  EXPECT_EQ(sample.n, 8);
  EXPECT_DOUBLE_EQ(sample.mean, 5);
  EXPECT_DOUBLE_EQ(sample.spread, std::sqrt(32.0 / 7));
  EXPECT_TRUE(std::isnan(StatisticsOf({}).mean));
  EXPECT_TRUE(std::isnan(StatisticsOf({1}).spread));
}

// Scans differ by much more than the variants do: their own effect must cancel
// exactly, and pairs with a missing partner must go. Breaks if differences are
// taken between means.
TEST(Statistics, PairingCancelsTheScan) {
  Random random(1);
  std::vector<double> reference, values;
  for (int i = 0; i < 20; ++i) {
    const double scan = random.Uniform(0, 1000);
    reference.push_back(scan);
    values.push_back(scan - 0.25 + (i % 2 == 0 ? 0.125 : -0.125));
  }
  values[3] = kNone;     // an odd one
  reference[4] = kNone;  // an even one
  const SampleStatistics difference = PairedDifference(values, reference);
  EXPECT_EQ(difference.n, 18);
  EXPECT_NEAR(difference.mean, -0.25, 1e-12);
  EXPECT_NEAR(difference.spread, 0.125 * std::sqrt(18.0 / 17), 1e-12);
  EXPECT_GT(StatisticsOf(values).spread, 100);
}

TEST(Statistics, AgainstItselfNothingDiffers) {
  const std::vector<double> values = {3.1, 2.7, kNone, 9};
  const SampleStatistics difference = PairedDifference(values, values);
  EXPECT_EQ(difference.n, 3);
  EXPECT_EQ(difference.mean, 0);
  EXPECT_EQ(difference.spread, 0);
}

TEST(Statistics, TimeToReachIsTheFirstPhaseBelow) {
  const std::vector<double> times = {0, 1, 2, 3}, energies = {100, 60, 21, 20};
  // 99 % of 100 - 20 is at 20.8.
  EXPECT_EQ(TimeToReach(0.99, 100, 20, times, energies), 3);
  EXPECT_EQ(TimeToReach(0.5, 100, 20, times, energies), 1);
  // The run that defines the best reaches all of it.
  EXPECT_EQ(TimeToReach(1, 100, 20, times, energies), 3);
  EXPECT_TRUE(std::isnan(TimeToReach(0.99, 100, 10, times, energies)));
  EXPECT_TRUE(std::isnan(TimeToReach(0.99, 100, 100, times, energies)));
}

}  // namespace
}  // namespace facet
