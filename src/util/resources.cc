// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "util/resources.h"

#include <sys/resource.h>

#include <algorithm>
#include <fstream>
#include <string>
#include <utility>

#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace facet {
namespace {

constexpr double kMb = 1024.0 * 1024.0;

// The number after `word` in a file of words, negative if there is none.
double NumberAfter(const char* file, const char* word) {
  std::ifstream in(file);
  std::string text;
  double number = -1;
  while (in >> text) {
    if (text == word) return in >> number ? number : -1;
  }
  return -1;
}

// The number that a file starts with, negative if it does not ("max").
double FirstNumber(const std::string& file) {
  std::ifstream in(file);
  double number = -1;
  return in >> number ? number : -1;
}

}  // namespace

double CpuSeconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& t) {
    return static_cast<double>(t.tv_sec) +
           1e-6 * static_cast<double>(t.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

double PeakRssMb() {
  const double kilobytes = NumberAfter("/proc/self/status", "VmHWM:");
  if (kilobytes >= 0) return kilobytes / 1024.0;
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

void ResetPeakRss() {
  std::ofstream clear("/proc/self/clear_refs");
  if (clear) clear << "5";
}

double AvailableMemoryMb() {
  double available =
      std::max(0.0, NumberAfter("/proc/meminfo", "MemAvailable:") / 1024.0);
  // Control groups, version 2 and 1. Without a limit version 1 gives a number
  // larger than any memory.
  const std::string root = "/sys/fs/cgroup/";
  for (const auto& [limit_file, usage_file] :
       {std::pair{"memory.max", "memory.current"},
        std::pair{"memory/memory.limit_in_bytes",
                  "memory/memory.usage_in_bytes"}}) {
    const double limit = FirstNumber(root + limit_file);
    const double usage = FirstNumber(root + usage_file);
    if (limit < 0 || usage < 0) continue;
    const double left = std::max(1.0, (limit - usage) / kMb);
    available = available > 0 ? std::min(available, left) : left;
  }
  return available;
}

Stopwatch::Stopwatch()
    : wall_start_(std::chrono::steady_clock::now()), cpu_start_(CpuSeconds()) {}

double Stopwatch::WallSeconds() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() -
                                       wall_start_)
      .count();
}

double Stopwatch::CpuSecondsSince() const { return CpuSeconds() - cpu_start_; }

void ReturnFreedMemory() {
#ifdef __GLIBC__
  malloc_trim(0);
#endif
}

}  // namespace facet
