// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// A 4-ary heap of the integers 0 ... n-1 by a key that may change; 20 bytes an
// integer. Equal keys: the smaller integer first.
#pragma once

#include <algorithm>
#include <vector>

namespace facet {

class IndexedHeap {
 public:
  explicit IndexedHeap(size_t n) : place_(n, -1) { entries_.reserve(n); }

  bool Empty() const { return entries_.empty(); }
  int Top() const { return entries_[0].id; }
  double TopKey() const { return entries_[0].key; }
  bool Contains(int id) const { return place_[id] >= 0; }

  // Inserts `id`, or changes its key.
  void Set(int id, double key) {
    int place = place_[id];
    if (place < 0) {
      place = static_cast<int>(entries_.size());
      entries_.push_back({key, id});
      Up(place, {key, id});
    } else {
      Move(place, {key, id});
    }
  }

  void Remove(int id) {
    const int place = place_[id];
    if (place < 0) return;
    place_[id] = -1;
    const Entry last = entries_.back();
    entries_.pop_back();
    if (place < static_cast<int>(entries_.size())) Move(place, last);
  }

 private:
  struct Entry {
    double key;
    int id;
    bool operator<(const Entry& other) const {
      return key != other.key ? key < other.key : id < other.id;
    }
  };

  void Put(int place, const Entry& entry) {
    entries_[place] = entry;
    place_[entry.id] = place;
  }

  // Puts `entry` where it belongs, from `place` on.
  void Move(int place, const Entry& entry) {
    if (place > 0 && entry < entries_[(place - 1) / 4]) {
      Up(place, entry);
    } else {
      Down(place, entry);
    }
  }

  void Up(int place, const Entry& entry) {
    while (place > 0) {
      const int parent = (place - 1) / 4;
      if (!(entry < entries_[parent])) break;
      Put(place, entries_[parent]);
      place = parent;
    }
    Put(place, entry);
  }

  void Down(int place, const Entry& entry) {
    const int size = static_cast<int>(entries_.size());
    for (;;) {
      const int first = 4 * place + 1;
      if (first >= size) break;
      int least = first;
      for (int child = first + 1; child < std::min(first + 4, size); ++child) {
        if (entries_[child] < entries_[least]) least = child;
      }
      if (!(entries_[least] < entry)) break;
      Put(place, entries_[least]);
      place = least;
    }
    Put(place, entry);
  }

  std::vector<Entry> entries_;
  std::vector<int> place_;  // of an integer, -1 = not in the heap
};

}  // namespace facet
