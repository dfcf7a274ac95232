// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// A 4-ary heap of the integers 0 ... n-1 by a key that may change; 20 bytes an
// integer. Equal keys: the smaller integer first. Large heaps do not fit into
// caches, so the four children of an entry share a line, and lines are asked
// for ahead of use.
#pragma once

#include <algorithm>

#include "util/fetch.h"
#include "util/huge_pages.h"

namespace facet {

class IndexedHeap {
 public:
  explicit IndexedHeap(size_t n) : lines_((n + 6) / 4), place_(n, -1) {}

  bool Empty() const { return size_ == 0; }
  int Top() const { return At(0).id; }
  double TopKey() const { return At(0).key; }
  bool Contains(int id) const { return place_[id] >= 0; }

  // The entry at a place, the integer or -1. The next top is at one of the
  // places 1 to 4, the one after it at 20 at most.
  int Peek(int place) const { return place < size_ ? At(place).id : -1; }

  // Hints that Set or Remove of `id` will follow; the second one reads what the
  // first one asks for.
  FACET_FETCH void FetchPlace(int id) const { __builtin_prefetch(&place_[id]); }
  FACET_FETCH void FetchEntry(int id) const {
    const int place = place_[id];
    if (place < 0) return;
    __builtin_prefetch(&At(place));
    __builtin_prefetch(&At((place + 3) / 4 - 1));  // above
    const size_t below = static_cast<size_t>(place) + 1;
    if (below < lines_.size()) __builtin_prefetch(&lines_[below]);
  }

  // Inserts `id`, or changes its key.
  void Set(int id, double key) {
    const int place = place_[id];
    if (place < 0) {
      Up(size_++, {key, id});
    } else {
      Move(place, {key, id});
    }
  }

  void Remove(int id) {
    const int place = place_[id];
    if (place < 0) return;
    place_[id] = -1;
    const Entry last = At(--size_);
    if (place < size_) Move(place, last);
  }

 private:
  struct Entry {
    double key;
    int id;
    bool operator<(const Entry& other) const {
      return key != other.key ? key < other.key : id < other.id;
    }
  };
  struct alignas(64) Line {
    Entry entries[4];
  };

  // The root is the last entry of the first line.
  Entry& At(int place) {
    return lines_[static_cast<size_t>(place + 3) / 4].entries[(place + 3) % 4];
  }
  const Entry& At(int place) const {
    return lines_[static_cast<size_t>(place + 3) / 4].entries[(place + 3) % 4];
  }

  void Put(int place, const Entry& entry) {
    At(place) = entry;
    place_[entry.id] = place;
  }

  // Puts `entry` where it belongs, from `place` on.
  void Move(int place, const Entry& entry) {
    if (place > 0 && entry < At((place - 1) / 4)) {
      Up(place, entry);
    } else {
      Down(place, entry);
    }
  }

  void Up(int place, const Entry& entry) {
    while (place > 0) {
      const int parent = (place - 1) / 4;
      if (!(entry < At(parent))) break;
      Put(place, At(parent));
      place = parent;
    }
    Put(place, entry);
  }

  void Down(int place, const Entry& entry) {
    for (;;) {
      const int first = 4 * place + 1;
      if (first >= size_) break;
      FetchChildren(first);
      int least = first;
      for (int child = first + 1; child < std::min(first + 4, size_); ++child) {
        if (At(child) < At(least)) least = child;
      }
      if (!(At(least) < entry)) break;
      Put(place, At(least));
      place = least;
    }
    Put(place, entry);
  }

  // The children of the four entries from `first` on.
  FACET_FETCH void FetchChildren(int first) const {
    const size_t line = static_cast<size_t>(first) + 1;
    for (size_t k = line; k < std::min(line + 4, lines_.size()); ++k) {
      __builtin_prefetch(&lines_[k]);
    }
  }

  HugeVector<Line> lines_;
  HugeVector<int> place_;  // of an integer, -1 = not in the heap
  int size_ = 0;
};

}  // namespace facet
