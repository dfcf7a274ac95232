// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "util/huge_pages.h"

#include <gtest/gtest.h>

#include <cstdint>

namespace facet {
namespace {

struct alignas(128) Wide {
  int value = 7;
};

template <typename T>
uintptr_t Misaligned(const HugeVector<T>& v, uintptr_t to) {
  return reinterpret_cast<uintptr_t>(v.data()) % to;
}

// Breaks if elements lie across lines of the cache, or large arrays across
// pages.
TEST(HugePageAllocator, Aligns) {
  EXPECT_EQ(Misaligned(HugeVector<char>(1), 64), 0u);
  EXPECT_EQ(Misaligned(HugeVector<Wide>(3), 128), 0u);
  EXPECT_EQ(Misaligned(HugeVector<int>(1 << 20), 2 << 20), 0u);  // 4 MB
}

// Breaks if growing from small to large arrays, or moving, loses contents.
TEST(HugePageAllocator, VectorsGrowAndMove) {
  HugeVector<int> v;
  for (int i = 0; i < 3 << 20; ++i) v.push_back(i);
  const HugeVector<int> moved = std::move(v);
  ASSERT_EQ(moved.size(), size_t{3} << 20);
  for (int i = 0; i < 3 << 20; ++i) ASSERT_EQ(moved[i], i);
  EXPECT_EQ(HugeVector<Wide>(5).back().value, 7);
}

// Breaks if a size that overflows gives a small array.
TEST(HugePageAllocator, RefusesWhatCannotBe) {
  EXPECT_THROW(HugePageAllocator<Wide>().allocate(SIZE_MAX / 64),
               std::bad_alloc);
}

}  // namespace
}  // namespace facet
