// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// A progress bar for long loops: on stderr, only when that is a terminal.
#pragma once

#include <cstddef>
#include <mutex>
#include <string>

namespace facet {

// Thread-safe. The bar vanishes when the object does.
class Progress {
 public:
  Progress(std::string label, size_t total);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void Add(size_t steps = 1);

 private:
  std::mutex mutex_;
  std::string label_;
  size_t total_;
  size_t done_ = 0;
  int shown_percent_ = -1;
  bool enabled_;
};

// Before other output while a bar may be on the line, of a loop on another
// thread: its next step draws the bar anew.
void ClearProgressLine();

}  // namespace facet
