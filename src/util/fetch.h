// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#pragma once

// For functions that only prefetch. GCC takes one for a function without effect
// and drops calls of it, unless it is inlined before that.
#define FACET_FETCH inline __attribute__((always_inline))
