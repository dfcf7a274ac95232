// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// facet-synthesize: a synthetic RGB-D scan of a furnished room with ground
// truth, in the folder layout of real scans.
#include <gflags/gflags.h>

#include <cstdio>

#include "apps/init_app.h"
#include "synth/synth_scan.h"
#include "util/errors.h"
#include "util/parallel_for.h"
#include "util/resources.h"

using facet::SynthOptions;

DEFINE_string(output, "", "the folder to write");
DEFINE_bool(overwrite,
            false,
            "write into a folder that is not empty; its frames are removed");
DEFINE_uint64(seed, 1, "layout, textures, path and noise all depend on it");
DEFINE_int32(frames, SynthOptions().num_frames, "number of frames");
DEFINE_int32(width, SynthOptions().width, "of colour and depth images [px]");
DEFINE_int32(height, SynthOptions().height, "of colour and depth images [px]");
DEFINE_double(
    pose_noise_mm,
    SynthOptions().pose_noise_mm,
    "rms error of every axis of the camera centres in the pose files, "
    "jitter and smooth drift in equal parts [mm]");
DEFINE_double(
    pose_noise_deg,
    SynthOptions().pose_noise_deg,
    "rms error of every axis of the rotations in the pose files [deg]");
DEFINE_bool(depth_noise,
            SynthOptions().depth_noise,
            "noise, quantisation, holes and frayed edges of a structured-light "
            "sensor; off: exact depth");
DEFINE_double(color_noise_grey,
              SynthOptions().color_noise_grey,
              "standard deviation of the colour noise [0-255]");
DEFINE_bool(exposure_drift,
            SynthOptions().exposure_drift,
            "the exposure wanders by about 12 %");
DEFINE_bool(vignetting,
            SynthOptions().vignetting,
            "colour images lose 30 % of light in the corners");
DEFINE_bool(motion_blur,
            SynthOptions().motion_blur,
            "the shutter is open for half the time between frames");
DEFINE_int32(threads, 0, "number of threads; 0 = one per core");

namespace facet {
namespace {

SynthOptions OptionsFromFlags() {
  SynthOptions options;
  options.num_frames = FLAGS_frames;
  options.width = FLAGS_width;
  options.height = FLAGS_height;
  options.pose_noise_mm = FLAGS_pose_noise_mm;
  options.pose_noise_deg = FLAGS_pose_noise_deg;
  options.depth_noise = FLAGS_depth_noise;
  options.color_noise_grey = FLAGS_color_noise_grey;
  options.exposure_drift = FLAGS_exposure_drift;
  options.vignetting = FLAGS_vignetting;
  options.motion_blur = FLAGS_motion_blur;
  return options;
}

int Synthesize() {
  if (FLAGS_output.empty()) {
    throw OptionsError("--output is missing: name the folder to write");
  }
  if (FLAGS_threads < 0) throw OptionsError("--threads must not be negative");
  CheckSynthOutput(FLAGS_output, FLAGS_overwrite);
  SetNumThreads(FLAGS_threads);
  const Stopwatch watch;
  const SynthScan scan = MakeRoom(FLAGS_seed, OptionsFromFlags());
  std::printf("room    seed %llu, %zu planes, %zu faces, %.1f s\n",
              static_cast<unsigned long long>(FLAGS_seed),
              scan.room.surfaces.size(),
              scan.room.mesh.NumFaces(),
              watch.WallSeconds());
  WriteSynthSequence(scan, FLAGS_output, FLAGS_overwrite);
  std::printf("frames  %d of %d x %d in '%s', %.1f s in all\n",
              FLAGS_frames,
              FLAGS_width,
              FLAGS_height,
              FLAGS_output.c_str(),
              watch.WallSeconds());
  return kExitOk;
}

}  // namespace
}  // namespace facet

int main(int argc, char** argv) {
  facet::AppDescription description;
  description.usage =
      "Renders a synthetic RGB-D scan of a furnished room with ground truth.\n"
      "  facet-synthesize --output=DIR --seed=1";
  return facet::RunApp(argc, argv, description, facet::Synthesize);
}
