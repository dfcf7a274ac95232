// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// RUN/trace_states.bin: poses and planes at the start and after every phase,
// one entry a line of trace.csv, so that their errors can be followed.
#pragma once

#include <string>
#include <vector>

#include "geometry/plane.h"
#include "geometry/pose.h"

namespace facet {

struct TraceState {
  std::vector<Pose> cam_from_world;  // colour camera, a keyframe
  std::vector<Plane> planes;         // by plane id
};

struct TraceStates {
  std::vector<int> keyframes;  // frame numbers
  std::vector<TraceState> states;
};

// Written atomically (docs/formats.md).
void WriteTraceStates(const std::string& path, const TraceStates& trace);

// Throws InputError.
TraceStates ReadTraceStates(const std::string& path);

}  // namespace facet
