// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "eval/trace_states.h"

#include "util/archive.h"
#include "util/errors.h"

namespace facet {

void WriteTraceStates(const std::string& path, const TraceStates& trace) {
  std::vector<double> poses, planes;
  for (const TraceState& state : trace.states) {
    for (const Pose& pose : state.cam_from_world) {
      const Eigen::Quaterniond& q = pose.rotation;
      const Eigen::Vector3d& t = pose.translation;
      poses.insert(poses.end(),
                   {q.x(), q.y(), q.z(), q.w(), t.x(), t.y(), t.z()});
    }
    for (const Plane& p : state.planes) {
      planes.insert(planes.end(),
                    {p.normal.x(), p.normal.y(), p.normal.z(), p.offset});
    }
  }
  ArchiveWriter writer;
  writer.meta["states"] = trace.states.size();
  writer.Add("keyframes", trace.keyframes);
  writer.Add("poses", poses);
  writer.Add("planes", planes);
  writer.Write(path);
}

TraceStates ReadTraceStates(const std::string& path) {
  const ArchiveReader reader(path);
  TraceStates trace;
  trace.keyframes = reader.Get<int>("keyframes");
  const auto poses = reader.Get<double>("poses");
  const auto planes = reader.Get<double>("planes");
  const size_t states = reader.meta().value("states", size_t{0});
  const size_t keyframes = trace.keyframes.size();
  if (states == 0 || poses.size() != 7 * keyframes * states ||
      planes.size() % (4 * states) != 0) {
    throw InputError(path + " is damaged: its arrays do not fit together");
  }
  trace.states.resize(states);
  const double* x = poses.data();
  const double* y = planes.data();
  for (TraceState& state : trace.states) {
    for (size_t k = 0; k < keyframes; ++k, x += 7) {
      state.cam_from_world.emplace_back(
          Eigen::Quaterniond(x[3], x[0], x[1], x[2]),
          Eigen::Vector3d(x[4], x[5], x[6]));
    }
    for (size_t j = 0; j < planes.size() / (4 * states); ++j, y += 4) {
      Plane plane;
      plane.normal = Eigen::Vector3d(y[0], y[1], y[2]);
      plane.offset = y[3];
      state.planes.push_back(plane);
    }
  }
  return trace;
}

}  // namespace facet
