// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// A 64-bit hash of bytes, the same in every run and build: identities of runs
// and of frozen observations. Not for anything that must resist an attacker.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

#include "util/random.h"

namespace facet {

class Hash64 {
 public:
  // Lengths are part of the hash: "ab" + "c" and "a" + "bc" differ.
  void Add(const void* data, size_t bytes) {
    Mix(bytes);
    const char* at = static_cast<const char*>(data);
    for (size_t done = 0; done < bytes; done += 8) {
      uint64_t word = 0;
      std::memcpy(&word, at + done, std::min<size_t>(8, bytes - done));
      Mix(word);
    }
  }
  void Add(const std::string& text) { Add(text.data(), text.size()); }
  // For element types without padding or pointers.
  template <typename T>
  void Add(const std::vector<T>& values) {
    Add(static_cast<const void*>(values.data()), values.size() * sizeof(T));
  }

  uint64_t value() const { return state_; }

  // 16 hexadecimal digits.
  std::string Text() const {
    char digits[17];
    std::snprintf(digits,
                  sizeof(digits),
                  "%016llx",
                  static_cast<unsigned long long>(state_));
    return digits;
  }

 private:
  void Mix(uint64_t word) { state_ = SplitMix64(state_ ^ word); }

  uint64_t state_ = 0x6a09e667f3bcc908ULL;
};

}  // namespace facet
