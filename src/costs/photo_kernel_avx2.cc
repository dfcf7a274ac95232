// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#define FACET_KERNEL_NAMESPACE kernel_avx2
#define FACET_KERNEL_NAME "avx2"
#include "costs/photo_kernel_impl.h"
