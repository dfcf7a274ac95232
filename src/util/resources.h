// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Time and memory of this process, for reports.
#pragma once

#include <chrono>

namespace facet {

// CPU seconds (user + system, all threads) since the process started.
double CpuSeconds();

// Largest resident memory of the process so far, in MB (2^20 bytes).
double PeakRssMb();

// Forgets the peak, so that the next PeakRssMb() is that of the stage to come.
// Does nothing where the system does not allow it.
void ResetPeakRss();

// Memory that can still be had without swapping, within the limit of the
// control group if there is one [MB]; 0 = the system does not say.
double AvailableMemoryMb();

// Wall and CPU time since construction.
class Stopwatch {
 public:
  Stopwatch();
  double WallSeconds() const;
  double CpuSecondsSince() const;

 private:
  std::chrono::steady_clock::time_point wall_start_;
  double cpu_start_;
};

// Gives memory that was freed back to the system, where the allocator keeps it
// (glibc): the next stage of a run needs other sizes.
void ReturnFreedMemory();

}  // namespace facet
