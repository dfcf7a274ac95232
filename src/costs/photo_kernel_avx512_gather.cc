// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#define FACET_KERNEL_NAMESPACE kernel_avx512_gather
#define FACET_KERNEL_NAME "avx512_gather"
#include "costs/photo_kernel_impl.h"
