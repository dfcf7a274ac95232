// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#define FACET_PRODUCT_NAMESPACE product_baseline
#define FACET_PRODUCT_EIGEN EigenOfProductBaseline
#include "problems/block_product_impl.h"
