// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Random numbers that are the same on every platform: the standard
// distributions are implementation-defined, so facet has its own.
#pragma once

#include <cmath>
#include <cstdint>

namespace facet {

// A 64-bit mix of `x`: stable hash of ids (colours of planes) and seeds.
inline uint64_t SplitMix64(uint64_t x) {
  x += 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

// A small generator (splitmix64 sequence).
class Random {
 public:
  explicit Random(uint64_t seed) : state_(SplitMix64(seed)) {}

  uint64_t NextBits() { return SplitMix64(state_++); }

  // Uniform in [0, 1).
  double Uniform() { return static_cast<double>(NextBits() >> 11) * 0x1.0p-53; }

  // Uniform in [low, high).
  double Uniform(double low, double high) {
    return low + (high - low) * Uniform();
  }

  // Uniform integer in [0, n), n > 0.
  uint64_t Index(uint64_t n) {
    return static_cast<uint64_t>(Uniform() * static_cast<double>(n));
  }

  // Standard normal (Box-Muller).
  double Normal() {
    const double radius = std::sqrt(-2.0 * std::log(1.0 - Uniform()));
    return radius * std::cos(6.283185307179586 * Uniform());
  }

 private:
  uint64_t state_;
};

}  // namespace facet
