// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "util/parallel_for.h"

#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <memory>
#include <thread>

namespace facet {
namespace {

std::unique_ptr<tbb::global_control>& Control() {
  static std::unique_ptr<tbb::global_control> control;
  return control;
}

}  // namespace

void SetNumThreads(int num_threads) {
  if (num_threads <= 0) {
    num_threads = static_cast<int>(std::thread::hardware_concurrency());
  }
  Control() = std::make_unique<tbb::global_control>(
      tbb::global_control::max_allowed_parallelism,
      static_cast<size_t>(std::max(1, num_threads)));
}

int NumThreads() {
  return static_cast<int>(tbb::global_control::active_value(
      tbb::global_control::max_allowed_parallelism));
}

void ParallelFor(size_t begin,
                 size_t end,
                 const std::function<void(size_t)>& body,
                 size_t grain) {
  if (begin >= end) return;
  tbb::parallel_for(tbb::blocked_range<size_t>(begin, end, grain),
                    [&](const tbb::blocked_range<size_t>& range) {
                      for (size_t i = range.begin(); i < range.end(); ++i) {
                        body(i);
                      }
                    });
}

void ParallelForChunks(size_t begin,
                       size_t end,
                       size_t chunk,
                       const std::function<void(size_t, size_t)>& body) {
  if (begin >= end) return;
  const size_t num_chunks = (end - begin + chunk - 1) / chunk;
  ParallelFor(0, num_chunks, [&](size_t c) {
    body(begin + c * chunk, std::min(end, begin + (c + 1) * chunk));
  });
}

}  // namespace facet
