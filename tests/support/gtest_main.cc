// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// main() of every test executable.
#include <glog/logging.h>
#include <gtest/gtest.h>

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  google::InitGoogleLogging(argv[0]);
  FLAGS_logtostderr = true;
  FLAGS_minloglevel = google::WARNING;
  return RUN_ALL_TESTS();
}
