// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#define FACET_PRODUCT_NAMESPACE product_avx2
#define FACET_PRODUCT_EIGEN EigenOfProductAvx2
#include "problems/block_product_impl.h"
