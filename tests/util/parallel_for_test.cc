// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "util/parallel_for.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <stdexcept>
#include <vector>

namespace facet {
namespace {

// Leaves the process with the default number of threads.
class ParallelForTest : public testing::Test {
 protected:
  void TearDown() override { SetNumThreads(0); }
};

// Breaks if an index is skipped or visited twice, e.g. at the end of a grain.
TEST_F(ParallelForTest, VisitsEveryIndexOnce) {
  for (const int threads : {1, 2, 5}) {
    SetNumThreads(threads);
    for (const size_t grain : {1, 7, 1000}) {
      std::vector<std::atomic<int>> visits(123);
      ParallelFor(
          3, visits.size(), [&](size_t i) { ++visits[i]; }, grain);
      for (size_t i = 0; i < visits.size(); ++i) {
        EXPECT_EQ(visits[i], i < 3 ? 0 : 1) << i;
      }
    }
  }
}

// Breaks if unsigned subtraction turns an empty range into a huge one.
TEST_F(ParallelForTest, EmptyRangeDoesNothing) {
  const auto fail = [](size_t) { ADD_FAILURE(); };
  ParallelFor(5, 5, fail);
  ParallelFor(6, 5, fail);
  ParallelForChunks(6, 5, 10, [](size_t, size_t) { ADD_FAILURE(); });
}

// Breaks if chunk borders depend on the number of threads: sums per chunk would
// then differ in the last digits.
TEST_F(ParallelForTest, ChunksAreFixedAndTileTheRange) {
  for (const int threads : {1, 2, 5}) {
    SetNumThreads(threads);
    std::vector<size_t> begin(4, 0), end(4, 0);
    ParallelForChunks(10, 41, 10, [&](size_t a, size_t b) {
      begin[(a - 10) / 10] = a;
      end[(a - 10) / 10] = b;
    });
    EXPECT_EQ(begin, (std::vector<size_t>{10, 20, 30, 40}));
    EXPECT_EQ(end, (std::vector<size_t>{20, 30, 40, 41}));
  }
}

// The rule of the house, in small: sums per chunk, added in order. Breaks if
// results depend on the schedule of the threads.
TEST_F(ParallelForTest, ChunkedSumHasTheSameBitsAtAnyThreadCount) {
  const auto sum = [](int threads) {
    SetNumThreads(threads);
    std::vector<double> partial(100, 0.0);
    ParallelForChunks(0, 10000, 100, [&](size_t a, size_t b) {
      for (size_t i = a; i < b; ++i) {
        partial[a / 100] += std::sin(static_cast<double>(i)) * 1e6;
      }
    });
    double total = 0;
    for (const double p : partial) total += p;
    return total;
  };
  const double one = sum(1);
  EXPECT_EQ(sum(2), one);
  EXPECT_EQ(sum(4), one);
}

// Breaks if errors thrown in a worker end the process instead of reaching main.
TEST_F(ParallelForTest, ExceptionsReachTheCaller) {
  SetNumThreads(2);
  EXPECT_THROW(ParallelFor(0,
                           100,
                           [](size_t i) {
                             if (i == 57) throw std::runtime_error("57");
                           }),
               std::runtime_error);
}

// Breaks if a second call cannot raise the limit that an earlier one set.
TEST_F(ParallelForTest, NumThreadsIsWhatWasSet) {
  for (const int threads : {1, 3, 2}) {
    SetNumThreads(threads);
    EXPECT_EQ(NumThreads(), threads);
  }
  SetNumThreads(0);
  EXPECT_GE(NumThreads(), 1);
}

}  // namespace
}  // namespace facet
