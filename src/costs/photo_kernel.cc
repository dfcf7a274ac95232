// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "costs/photo_kernel.h"

#include <cstdlib>
#include <cstring>
#include <string>

#include "util/warnings.h"

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

const PhotoKernel* FindPhotoKernel(const char* name) {
#if defined(__x86_64__)
  const bool avx2 =
      __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  if (std::strcmp(name, "avx512") == 0 && avx2 &&
      __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512vl")) {
    return &kernel_avx512::kKernel;
  }
  if (std::strcmp(name, "avx2") == 0 && avx2) return &kernel_avx2::kKernel;
#endif
  return std::strcmp(name, "baseline") == 0 ? &kernel_baseline::kKernel
                                            : nullptr;
}

namespace {

const PhotoKernel& Choose() {
  if (const char* wish = std::getenv("FACET_KERNEL")) {
    if (const PhotoKernel* kernel = FindPhotoKernel(wish)) return *kernel;
    AddWarning("FACET_KERNEL=" + std::string(wish) +
               " is not available on this processor; use baseline, avx2 or "
               "avx512. The fastest kernel is taken");
  }
  for (const char* name : {"avx512", "avx2"}) {
    if (const PhotoKernel* kernel = FindPhotoKernel(name)) return *kernel;
  }
  return kernel_baseline::kKernel;
}

}  // namespace

const PhotoKernel& GetPhotoKernel() {
  static const PhotoKernel& kernel = Choose();
  return kernel;
}

}  // namespace facet
