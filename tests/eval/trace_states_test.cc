// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "eval/trace_states.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "tests/support/temp_dir.h"
#include "util/archive.h"
#include "util/errors.h"
#include "util/random.h"

namespace facet {
namespace {

// Breaks if poses and planes of several states are mixed up.
TEST(TraceStates, RoundTrip) {
  Random random(1);
  TraceStates trace;
  trace.keyframes = {3, 8, 21};
  for (int s = 0; s < 4; ++s) {
    TraceState state;
    for (int k = 0; k < 3; ++k) {
      state.cam_from_world.emplace_back(
          Eigen::Quaterniond(random.Normal(),
                             random.Normal(),
                             random.Normal(),
                             random.Normal()),
          Eigen::Vector3d(random.Normal(), random.Normal(), random.Normal()));
    }
    for (int j = 0; j < 5; ++j) {
      Plane plane;
      plane.normal = Eigen::Vector3d(random.Normal(), 1, 0).normalized();
      plane.offset = random.Normal();
      state.planes.push_back(plane);
    }
    trace.states.push_back(state);
  }
  const TempDir dir;
  WriteTraceStates(dir / "trace_states.bin", trace);
  const TraceStates back = ReadTraceStates(dir / "trace_states.bin");
  EXPECT_EQ(back.keyframes, trace.keyframes);
  ASSERT_EQ(back.states.size(), 4u);
  for (size_t s = 0; s < 4; ++s) {
    ASSERT_EQ(back.states[s].cam_from_world.size(), 3u);
    ASSERT_EQ(back.states[s].planes.size(), 5u);
    for (size_t k = 0; k < 3; ++k) {
      EXPECT_TRUE(back.states[s].cam_from_world[k].Matrix().isApprox(
          trace.states[s].cam_from_world[k].Matrix(), 1e-14));
    }
    for (size_t j = 0; j < 5; ++j) {
      EXPECT_EQ(back.states[s].planes[j].normal,
                trace.states[s].planes[j].normal);
      EXPECT_EQ(back.states[s].planes[j].offset,
                trace.states[s].planes[j].offset);
    }
  }
}

TEST(TraceStates, DamagedFilesAreRefused) {
  const TempDir dir;
  EXPECT_THROW(ReadTraceStates(dir / "none.bin"), InputError);
  ArchiveWriter writer;
  writer.meta["states"] = 2;
  writer.Add("keyframes", std::vector<int>{1, 2});
  writer.Add("poses", std::vector<double>(7 * 3));
  writer.Add("planes", std::vector<double>(8));
  writer.Write(dir / "wrong.bin");
  EXPECT_THROW(ReadTraceStates(dir / "wrong.bin"), InputError);
}

}  // namespace
}  // namespace facet
