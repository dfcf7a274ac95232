// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "util/background.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <vector>

#include "util/parallel_for.h"

namespace facet {
namespace {

class ThreadCount : public testing::TestWithParam<int> {
 protected:
  void SetUp() override { SetNumThreads(GetParam()); }
  void TearDown() override { SetNumThreads(0); }
};

// Breaks if the work is dropped, or if it waits for a thread that never comes.
TEST_P(ThreadCount, FinishBringsTheResult) {
  std::vector<int> squares(1000);
  Background background([&] {
    ParallelFor(0, squares.size(), [&](size_t i) {
      squares[i] = static_cast<int>(i * i);
    });
  });
  std::atomic<int> sum{0};
  ParallelFor(0, 100, [&](size_t i) { sum += static_cast<int>(i); });
  background.Finish();
  background.Finish();  // nothing more to wait for
  EXPECT_EQ(sum, 4950);
  for (size_t i = 0; i < squares.size(); ++i) {
    ASSERT_EQ(squares[i], static_cast<int>(i * i));
  }
}

// Breaks if an error of the work is lost, or thrown where nobody asked.
TEST_P(ThreadCount, ErrorsComeWithFinish) {
  Background background([] { throw std::runtime_error("no image"); });
  EXPECT_THROW(background.Finish(), std::runtime_error);
}

// Breaks if the work can outlive what it writes to, or throws on the way out.
TEST_P(ThreadCount, DroppedWorkIsOver) {
  std::atomic<int> running{0};
  {
    Background background([&] {
      ++running;
      --running;
      throw std::runtime_error("unheard");
    });
  }
  EXPECT_EQ(running, 0);
}

INSTANTIATE_TEST_SUITE_P(Background, ThreadCount, testing::Values(1, 2, 4));

}  // namespace
}  // namespace facet
