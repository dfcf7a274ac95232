// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "util/progress.h"

#include <unistd.h>

#include <cstdio>
#include <utility>

namespace facet {

void ClearProgressLine() {
  if (isatty(STDERR_FILENO) != 0) std::fprintf(stderr, "\r\033[K");
}

Progress::Progress(std::string label, size_t total)
    : label_(std::move(label)),
      total_(total),
      enabled_(total > 0 && isatty(STDERR_FILENO) != 0) {}

Progress::~Progress() {
  if (enabled_ && shown_percent_ >= 0) ClearProgressLine();
}

void Progress::Add(size_t steps) {
  if (!enabled_) return;
  const std::lock_guard<std::mutex> lock(mutex_);
  done_ += steps;
  const int percent = static_cast<int>(100 * done_ / total_);
  if (percent == shown_percent_) return;
  shown_percent_ = percent;
  const int bars = percent * 30 / 100;
  std::fprintf(stderr,
               "\r%-24s [%-30.*s] %3d %%",
               label_.c_str(),
               bars,
               "==============================",
               percent);
}

}  // namespace facet
