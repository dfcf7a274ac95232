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
namespace kernel_avx512_gather {
extern const PhotoKernel kKernel;
}
#endif

const PhotoKernel* FindPhotoKernel(const char* name) {
  const auto is = [name](const char* other) {
    return std::strcmp(name, other) == 0;
  };
#if defined(__x86_64__)
  const bool avx2 =
      __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  const bool avx512 = avx2 && __builtin_cpu_supports("avx512f") &&
                      __builtin_cpu_supports("avx512dq") &&
                      __builtin_cpu_supports("avx512vl");
  const bool gather = avx512 && __builtin_cpu_supports("avx512fp16");
  if (gather && is("avx512_gather")) return &kernel_avx512_gather::kKernel;
  if (avx512 && is("avx512")) return &kernel_avx512::kKernel;
  if (avx2 && is("avx2")) return &kernel_avx2::kKernel;
#endif
  return is("baseline") ? &kernel_baseline::kKernel : nullptr;
}

namespace {

const PhotoKernel& Choose() {
  if (const char* wish = std::getenv("FACET_KERNEL")) {
    if (const PhotoKernel* kernel = FindPhotoKernel(wish)) return *kernel;
    std::string names;
    for (const char* name : kPhotoKernelNames) {
      if (!FindPhotoKernel(name)) continue;
      names += (names.empty() ? "" : ", ") + std::string(name);
    }
    AddWarning("FACET_KERNEL=" + std::string(wish) +
               " is not available on this processor, which has " + names +
               ". The fastest kernel is taken");
  }
  for (const char* name : kPhotoKernelNames) {
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
