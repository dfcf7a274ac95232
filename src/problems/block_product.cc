// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "problems/block_product.h"

#include <cstring>

#include "costs/photo_kernel.h"

namespace facet {

namespace product_baseline {
extern void SubtractProduct(const BlockProduct& p);
}
namespace product_avx2 {
extern void SubtractProduct(const BlockProduct& p);
}

SubtractProductFunction BaselineSubtractProduct() {
  return product_baseline::SubtractProduct;
}

SubtractProductFunction Avx2SubtractProduct() {
#if defined(__x86_64__)
  // AVX-512 would be slower: Eigen 3.4 makes less of it than of AVX2.
  if (FindPhotoKernel("avx2")) return product_avx2::SubtractProduct;
#endif
  return nullptr;
}

void SubtractProduct(const BlockProduct& product) {
  static const SubtractProductFunction function = [] {
    const bool baseline = std::strcmp(GetPhotoKernel().name, "baseline") == 0;
    const SubtractProductFunction fast = Avx2SubtractProduct();
    return baseline || !fast ? BaselineSubtractProduct() : fast;
  }();
  function(product);
}

}  // namespace facet
