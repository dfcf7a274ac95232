// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "util/background.h"

#include <tbb/task_group.h>

#include <utility>

namespace facet {

struct Background::Impl {
  tbb::task_group tasks;
};

Background::Background(std::function<void()> work)
    : impl_(std::make_unique<Impl>()) {
  impl_->tasks.run(std::move(work));
}

Background::~Background() {
  impl_->tasks.cancel();
  try {
    impl_->tasks.wait();
  } catch (...) {
    // Nobody waits for the result any more.
  }
}

void Background::Finish() { impl_->tasks.wait(); }

}  // namespace facet
