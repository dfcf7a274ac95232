// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#define FACET_KERNEL_NAMESPACE kernel_baseline
#define FACET_KERNEL_NAME "baseline"
#include "costs/photo_kernel_impl.h"
