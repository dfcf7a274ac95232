// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Announces stages and measures them.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "util/resources.h"

namespace facet {

// One line on stdout, flushed: progress is read by people and scripts.
void PrintLine(const std::string& line);

// Measures one stage from construction to Finish, which prints one line.
class StageClock {
 public:
  explicit StageClock(const std::string& name);
  // `summary`: what came out, one clause. Returns the entry for
  // report.json: {name, wall_s, cpu_s, peak_rss_mb}.
  nlohmann::json Finish(const std::string& summary);

 private:
  std::string name_;
  Stopwatch watch_;
};

}  // namespace facet
