// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The product that most of a dense factorisation consists of, with the
// instructions that the processor has: Eigen's, compiled again for AVX2 and FMA
// in a namespace of its own, 2.5 times as fast there as the packaged baseline.
#pragma once

#include <cstddef>

namespace facet {

// C -= A' B, column-major: A is depth x rows, B depth x cols, C rows x cols.
// Strides are what columns are apart, in numbers.
struct BlockProduct {
  ptrdiff_t rows, cols, depth;
  const double* a;
  const double* b;
  ptrdiff_t input_stride;
  double* c;
  ptrdiff_t output_stride;
};

// The result depends on the processor, in the last bits, and on nothing else.
// FACET_KERNEL=baseline (costs/photo_kernel.h) takes the baseline here too.
void SubtractProduct(const BlockProduct& product);

// What SubtractProduct chooses from; for tests. The second is null where the
// processor or the build lacks it.
using SubtractProductFunction = void (*)(const BlockProduct&);
SubtractProductFunction BaselineSubtractProduct();
SubtractProductFunction Avx2SubtractProduct();

}  // namespace facet
