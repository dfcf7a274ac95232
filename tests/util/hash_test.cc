// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "util/hash.h"

#include <gtest/gtest.h>

#include <set>

namespace facet {
namespace {

std::string HashOf(const std::vector<std::string>& parts) {
  Hash64 hash;
  for (const std::string& part : parts) hash.Add(part);
  return hash.Text();
}

// Breaks if bytes beyond the last whole word, or the borders between parts, do
// not count: two runs would then share an identity.
TEST(Hash64, EveryByteAndEveryBorderCounts) {
  std::set<std::string> seen;
  size_t texts = 0;
  for (size_t length = 0; length < 20; ++length) {
    seen.insert(HashOf({std::string(length, 'a')}));
    ++texts;
    for (size_t i = 0; i < length; ++i) {
      std::string text(length, 'a');
      text[i] = 'b';
      seen.insert(HashOf({text}));
      ++texts;
    }
  }
  EXPECT_EQ(seen.size(), texts);
  EXPECT_NE(HashOf({"ab", "c"}), HashOf({"a", "bc"}));
  EXPECT_NE(HashOf({"ab", ""}), HashOf({"ab"}));
}

TEST(Hash64, VectorsHashAsTheirBytes) {
  Hash64 numbers, bytes;
  const std::vector<uint32_t> values = {1, 2, 3};
  numbers.Add(values);
  bytes.Add(values.data(), 12);
  EXPECT_EQ(numbers.value(), bytes.value());
}

}  // namespace
}  // namespace facet
