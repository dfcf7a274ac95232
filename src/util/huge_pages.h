// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#pragma once

#include <sys/mman.h>

#include <cstdlib>
#include <new>
#include <vector>

namespace facet {

// Allocates in pages of 2 MB where the system has them: for arrays of hundreds
// of megabytes that are read in no order, whose addresses would otherwise have
// to be looked up in page tables every time. Smaller arrays (less than 4 MB)
// are aligned to a line of the cache. Throws std::bad_alloc. Linux.
template <typename T>
struct HugePageAllocator {
  using value_type = T;

  HugePageAllocator() = default;
  template <typename U>
  HugePageAllocator(const HugePageAllocator<U>&) {}  // NOLINT: as std has it

  T* allocate(size_t n) {
    constexpr size_t kPage = size_t{2} << 20;
    if (n > static_cast<size_t>(-1) / 2 / sizeof(T)) throw std::bad_alloc();
    const size_t bytes = n * sizeof(T);
    const size_t alignment = bytes < 2 * kPage ? kSmallAlignment : kPage;
    const size_t padded = (bytes + alignment - 1) / alignment * alignment;
    void* memory = std::aligned_alloc(alignment, padded);
    if (!memory) throw std::bad_alloc();
    // A hint: nothing is wrong if it is not taken.
    if (alignment == kPage) madvise(memory, padded, MADV_HUGEPAGE);
    return static_cast<T*>(memory);
  }
  void deallocate(T* memory, size_t) { std::free(memory); }

  bool operator==(const HugePageAllocator&) const { return true; }
  bool operator!=(const HugePageAllocator&) const { return false; }

 private:
  static constexpr size_t kSmallAlignment = alignof(T) < 64 ? 64 : alignof(T);
};

template <typename T>
using HugeVector = std::vector<T, HugePageAllocator<T>>;

}  // namespace facet
