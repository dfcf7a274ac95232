// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Disjoint sets of the integers 0 ... n-1, 4 bytes each.
#pragma once

#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

namespace facet {

class UnionFind {
 public:
  explicit UnionFind(size_t n) : parent_(n) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }

  // The representative of i's set. Halves paths as it goes.
  int Find(int i) {
    while (parent_[i] != i) {
      parent_[i] = parent_[parent_[i]];
      i = parent_[i];
    }
    return i;
  }

  // Joins the sets; the smaller representative stays, so that the result does
  // not depend on the order of the calls.
  void Unite(int i, int j) {
    i = Find(i);
    j = Find(j);
    if (i > j) std::swap(i, j);
    parent_[j] = i;
  }

  // Joins the set of `from` to that of `into`, whose representative stays.
  void Attach(int from, int into) { parent_[Find(from)] = Find(into); }

 private:
  std::vector<int> parent_;
};

}  // namespace facet
