// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#pragma once

#include "synth/paint.h"
#include "util/random.h"

namespace facet {

// The room's dice, and paints with a fresh seed each.
class PaintMaker {
 public:
  explicit PaintMaker(uint64_t seed) : random_(seed) {}

  float Unit() { return static_cast<float>(random_.Uniform()); }
  double Range(double low, double high) { return random_.Uniform(low, high); }
  int Index(int n) { return static_cast<int>(random_.Index(n)); }

  Paint Make(PaintStyle style);
  Paint Wood();  // a random kind of wood
  Paint Poster() { return Make(PaintStyle::kPoster); }
  Paint Print();   // a page
  Paint Cover();   // a book
  Paint Fabric();  // upholstery

 private:
  Random random_;
};

}  // namespace facet
