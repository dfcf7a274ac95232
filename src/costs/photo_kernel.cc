// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "costs/photo_kernel.h"

#include <cstdlib>
#include <cstring>

namespace facet {

namespace kernel_baseline {
extern const PhotoKernel kKernel;
}
#if defined(__x86_64__)
namespace kernel_avx2 {
extern const PhotoKernel kKernel;
}
namespace kernel_avx512 {
extern const PhotoKernel kKernel;
}
#endif

namespace {

const PhotoKernel& Choose() {
#if defined(__x86_64__)
  const char* wish = std::getenv("FACET_KERNEL");
  const auto wants = [&](const char* name) {
    return wish == nullptr || std::strcmp(wish, name) == 0;
  };
  if (wants("avx512") && __builtin_cpu_supports("avx512f") &&
      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl")) {
    return kernel_avx512::kKernel;
  }
  if (wants("avx2") && __builtin_cpu_supports("avx2") &&
      __builtin_cpu_supports("fma")) {
    return kernel_avx2::kKernel;
  }
#endif
  return kernel_baseline::kKernel;
}

}  // namespace

const PhotoKernel& GetPhotoKernel() {
  static const PhotoKernel& kernel = Choose();
  return kernel;
}

}  // namespace facet
