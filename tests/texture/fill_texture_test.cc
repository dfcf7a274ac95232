// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "texture/fill_texture.h"

#include <gtest/gtest.h>

#include "util/random.h"

namespace facet {
namespace {

using Eigen::Vector3f;

TEST(PushPull, KeepsWhatIsKnownAndStaysWithinIt) {
  // Known pixels unchanged, filled ones inside the range of known ones; nothing
  // known: false.
  Random random(2);
  const int width = 37, height = 21;
  std::vector<float> weight(width * height, 0);
  std::vector<Vector3f> color(width * height, Vector3f::Zero());
  for (int i = 0; i < 40; ++i) {
    const size_t j = random.Index(weight.size());
    weight[j] = 1;
    color[j] = Vector3f::Constant(static_cast<float>(random.Uniform(50, 90)));
  }
  std::vector<Vector3f> filled = color;
  ASSERT_TRUE(PushPull(width, height, weight, &filled));
  for (size_t i = 0; i < weight.size(); ++i) {
    if (weight[i] > 0) {
      EXPECT_EQ(filled[i], color[i]);
    }
    EXPECT_GE(filled[i].x(), 50 - 1e-3);
    EXPECT_LE(filled[i].x(), 90 + 1e-3);
  }
  weight.assign(weight.size(), 0);
  EXPECT_FALSE(PushPull(width, height, weight, &filled));
}

}  // namespace
}  // namespace facet
