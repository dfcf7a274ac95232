// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "util/random.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace facet {
namespace {

// The first outputs of the published generator for seed 0 (Steele, Lea, Flood
// 2014), whose state grows by the same constant. Breaks if a constant or a
// shift is mistyped.
TEST(SplitMix64, AgreesWithThePublishedGenerator) {
  EXPECT_EQ(SplitMix64(0), 0xe220a8397b1dcdafULL);
  EXPECT_EQ(SplitMix64(0x9e3779b97f4a7c15ULL), 0x6e789e6aa1b965f4ULL);
}

// Breaks if the sequence depends on anything but the seed, or if neighbouring
// seeds (keyframe numbers) give overlapping sequences.
TEST(Random, SequenceBelongsToTheSeed) {
  Random a(5), b(5), c(6);
  int equal = 0;
  for (int i = 0; i < 1000; ++i) {
    const uint64_t bits = a.NextBits();
    EXPECT_EQ(bits, b.NextBits());
    equal += bits == c.NextBits() ? 1 : 0;
  }
  EXPECT_EQ(equal, 0);
}

// Mean 1/2, variance 1/12, range [0, 1). 1e5 draws: the standard error of the
// mean is 0.0009, the bound is 5 of them. Breaks if bits are lost or the scale
// is wrong.
TEST(Random, UniformHasMeanVarianceAndRange) {
  Random random(1);
  const int n = 100000;
  double sum = 0, squares = 0;
  for (int i = 0; i < n; ++i) {
    const double x = random.Uniform();
    ASSERT_GE(x, 0.0);
    ASSERT_LT(x, 1.0);
    sum += x;
    squares += x * x;
  }
  const double mean = sum / n;
  EXPECT_NEAR(mean, 0.5, 0.0046);
  EXPECT_NEAR(squares / n - mean * mean, 1.0 / 12, 0.002);
}

// Mean 0, variance 1, no skew, kurtosis 3, no infinity. Breaks if Box-Muller
// uses the same draw twice or log(0).
TEST(Random, NormalHasTheMomentsOfANormal) {
  Random random(2);
  const int n = 100000;
  double m1 = 0, m2 = 0, m3 = 0, m4 = 0;
  for (int i = 0; i < n; ++i) {
    const double x = random.Normal();
    ASSERT_TRUE(std::isfinite(x));
    m1 += x / n;
    m2 += x * x / n;
    m3 += x * x * x / n;
    m4 += x * x * x * x / n;
  }
  EXPECT_NEAR(m1, 0, 0.016);
  EXPECT_NEAR(m2, 1, 0.023);
  EXPECT_NEAR(m3, 0, 0.06);
  EXPECT_NEAR(m4, 3, 0.16);
}

// Breaks if Index can return n or favours a value (6 values, 60 000 draws, 5
// standard deviations of a binomial).
TEST(Random, IndexIsUniformBelowN) {
  Random random(3);
  std::vector<int> count(6, 0);
  for (int i = 0; i < 60000; ++i) {
    const uint64_t k = random.Index(6);
    ASSERT_LT(k, 6u);
    ++count[k];
  }
  for (const int c : count) EXPECT_NEAR(c, 10000, 460);
  EXPECT_EQ(random.Index(1), 0u);
}

}  // namespace
}  // namespace facet
