// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// What the benchmark programs have in common: one optional argument, `small`,
// which shrinks everything to what a smoke test can afford; one thread; CSV on
// stdout; CPU seconds as the best of some repetitions, because other programs
// on the machine can only add to them.
#pragma once

#include <glog/logging.h>

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>

#include "util/parallel_for.h"
#include "util/resources.h"

namespace facet {

struct BenchArgs {
  bool small = false;
  int repetitions = 5;
};

inline BenchArgs StartBenchmark(int argc, char** argv) {
  google::InitGoogleLogging(argv[0]);
  FLAGS_minloglevel = google::ERROR;
  SetNumThreads(1);
  BenchArgs args;
  if (argc == 2 && std::strcmp(argv[1], "small") == 0) {
    args = {true, 1};
  } else if (argc != 1) {
    std::fprintf(stderr, "usage: %s [small]\n", argv[0]);
    std::exit(2);
  }
  return args;
}

// CPU seconds of `work`, the least of the repetitions.
template <typename Work>
double BestCpuSeconds(int repetitions, const Work& work) {
  double best = std::numeric_limits<double>::infinity();
  for (int i = 0; i < repetitions; ++i) {
    const Stopwatch watch;
    work();
    best = std::min(best, watch.CpuSecondsSince());
  }
  return best;
}

}  // namespace facet
