// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Work for threads that have nothing to do while the caller goes on.
#pragma once

#include <functional>
#include <memory>

namespace facet {

class Background {
 public:
  // `work` begins as soon as a thread is free, with a single one not before
  // Finish. Loops in it are shared among threads (ParallelFor).
  explicit Background(std::function<void()> work);

  // Drops what has not begun, loops of the work among it, and waits for what
  // has: without Finish its result is of no use.
  ~Background();
  Background(const Background&) = delete;
  Background& operator=(const Background&) = delete;

  // Returns when the work is done, to which this thread lends a hand. Throws
  // what the work threw. Called again it returns at once.
  void Finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace facet
