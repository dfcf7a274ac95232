// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "pipeline/stage_clock.h"

#include <cstdio>

#include "util/progress.h"

namespace facet {

void PrintLine(const std::string& line) {
  ClearProgressLine();
  std::printf("%s\n", line.c_str());
  std::fflush(stdout);
}

StageClock::StageClock(const std::string& name) : name_(name) {
  ResetPeakRss();
}

nlohmann::json StageClock::Finish(const std::string& summary) {
  const double wall = watch_.WallSeconds(), cpu = watch_.CpuSecondsSince();
  const double peak = PeakRssMb();
  char line[400];
  std::snprintf(line,
                sizeof(line),
                "%-12s %7.1f s %8.0f MB  %s",
                name_.c_str(),
                wall,
                peak,
                summary.c_str());
  PrintLine(line);
  return {
      {"name", name_}, {"wall_s", wall}, {"cpu_s", cpu}, {"peak_rss_mb", peak}};
}

}  // namespace facet
