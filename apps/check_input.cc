// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// facet-check-input: says what a scan and a mesh consist of, and whether they
// belong together under the conventions given. Exit 0 if they do, 3 if not.
#include <gflags/gflags.h>

#include <cstdio>
#include <limits>

#include "apps/flags/sequence.h"
#include "apps/init_app.h"
#include "eval/input_check.h"
#include "mesh/mesh_io.h"
#include "util/errors.h"

DEFINE_string(mesh, "", "the dense mesh, .ply or .obj");
DEFINE_int32(check_frames,
             facet::InputCheckOptions().num_frames,
             "number of frames that are compared");

namespace facet {
namespace {

void PrintCamera(const char* name, const Pinhole& c) {
  std::printf("%-10s %dx%d, fx %.2f fy %.2f cx %.2f cy %.2f\n",
              name,
              c.width,
              c.height,
              c.fx,
              c.fy,
              c.cx,
              c.cy);
}

void PrintSequence(const RgbdSequence& sequence) {
  const RgbdCalibration& c = sequence.calibration();
  PrintCamera("colour", c.color);
  PrintCamera("depth", c.depth);
  const Eigen::Vector3d& t = c.color_from_depth.translation;
  std::printf("%-10s %.1f %.1f %.1f mm, %.2f degrees apart, depth shift %g\n",
              "cameras",
              1e3 * t.x(),
              1e3 * t.y(),
              1e3 * t.z(),
              RotationAngle(c.color_from_depth) * 180 / M_PI,
              c.depth_shift);
  size_t usable = 0;
  for (const Frame& frame : sequence.frames()) usable += frame.usable;
  const int first = sequence.frames().front().number;
  const int last = sequence.frames().back().number;
  std::printf("%-10s %zu, numbers %d to %d (%zu absent), %zu usable\n",
              "frames",
              sequence.frames().size(),
              first,
              last,
              static_cast<size_t>(last - first + 1) - sequence.frames().size(),
              usable);
}

void PrintMesh(const TriMesh& mesh) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Eigen::Vector3d low = Eigen::Vector3d::Constant(kInfinity), high = -low;
  for (const Eigen::Vector3d& v : mesh.vertices) {
    if (!v.allFinite()) continue;
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
  const Eigen::Vector3d size = high - low;
  std::printf("%-10s %zu vertices, %zu faces, %.2f x %.2f x %.2f m\n",
              "mesh",
              mesh.NumVertices(),
              mesh.NumFaces(),
              size.x(),
              size.y(),
              size.z());
}

void PrintTable(const InputCheck& check) {
  std::printf("\n%-29s %14s %9s %9s\n",
              "poses",
              "depth shift",
              "coverage",
              "agreement");
  for (size_t i = 0; i < check.readings.size(); ++i) {
    const Reading& reading = check.readings[i];
    std::printf("%-29s %10.1f %3s %7.1f %% %7.1f %%%s%s\n",
                DescribePoses(reading).c_str(),
                reading.depth_shift,
                reading.estimated_shift ? "est" : "",
                100 * reading.Coverage(),
                100 * reading.Agreement(),
                i == 0 ? "  given" : "",
                static_cast<int>(i) == check.best ? "  best" : "");
  }
}

int Run() {
  if (FLAGS_mesh.empty()) {
    throw OptionsError("--mesh is missing: give the dense mesh");
  }
  InputCheckOptions options;
  options.num_frames = FLAGS_check_frames;
  if (options.num_frames < 1) {
    throw OptionsError("--check_frames must be at least 1");
  }
  const auto sequence = OpenSequenceFromFlags();
  PrintSequence(*sequence);
  const TriMesh mesh = ReadMesh(FLAGS_mesh).mesh;
  PrintMesh(mesh);
  const InputCheck check = CheckInput(*sequence, mesh, options);
  std::printf(
      "%-10s %zu frames, %.1f %% of the pixels have depth, %.1f %% of "
      "these lie on the mesh\n",
      "compared",
      check.frames.size(),
      100 * check.depth_share,
      100 * check.readings[0].Coverage());
  PrintTable(check);
  std::printf("\n%s\n", check.verdict.c_str());
  return check.given_fits ? kExitOk : kExitInput;
}

}  // namespace
}  // namespace facet

int main(int argc, char** argv) {
  return facet::RunApp(
      argc,
      argv,
      {"Checks whether a scan and a mesh belong together: sizes, frames, pose "
       "direction, axes and depth unit.\n"
       "  facet-check-input --sequence=DIR --mesh=dense.ply",
       {}},
      facet::Run);
}
