// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "pipeline/preflight.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "eval/input_check.h"
#include "schedule/schedule.h"
#include "util/errors.h"
#include "util/parallel_for.h"
#include "util/warnings.h"

namespace facet {
namespace {

constexpr double kMb = 1024.0 * 1024.0;
constexpr double kBaseMb = 60;  // code, libraries, buffers
constexpr double kBytesPerFace = 390, kBytesPerKeptFace = 70;
constexpr double kColorBytes = 3, kDepthBytes = 2;  // a pixel
constexpr double kLumaBytes = 4, kSmoothBytes = 4;  // while optimising
constexpr double kDrawingMb = 130, kBytesPerDrawnFace = 100;
constexpr double kSolverMb = 180;
constexpr double kBytesPerPair = 850;  // of keyframes: 3 copies of 6 x 6
constexpr double kBytesPerSampledTexel = 100, kBytesPerObservation = 11;
constexpr double kBytesPerAtlasTexel = 150;
constexpr double kSeenShare = 0.15;  // of the keyframes see a texel
constexpr double kWorkBytes = 40;    // a pixel of an image that is being made

// Phases whose solver sees all smooth images at once.
bool ReadsAllImagesAtOnce(const PhotometricOptions& options) {
  const JointMethod joint = options.solver.joint_method;
  const std::vector<SolvedSet> phases =
      PhasesOf(ParseSchedule(options.schedule, joint), joint);
  return std::any_of(phases.begin(), phases.end(), [](const SolvedSet& phase) {
    const bool colors = (phase.blocks & kColors) != 0;
    return phase.blocks == kPlanes || (colors && phase.blocks != kColors &&
                                       HasExplicitColors(phase.joint));
  });
}

}  // namespace

SceneSize MeasureScene(const ReconstructOptions& options,
                       const TriMesh& dense,
                       const RgbdSequence& sequence) {
  SceneSize size;
  size.faces = dense.NumFaces();
  for (size_t f = 0; f < dense.NumFaces(); ++f) {
    size.area_m2 += dense.FaceArea(f);
  }
  size_t usable = 0;
  for (const Frame& frame : sequence.frames()) {
    usable +=
        frame.usable && !IsHeldOut(frame.number, options.keyframes) ? 1 : 0;
  }
  const size_t window = std::max(options.keyframes.window, 1);
  size.keyframes = (usable + window - 1) / window;
  const Pinhole& camera = sequence.calibration().color;
  size.image_pixels = static_cast<size_t>(camera.width) * camera.height;
  return size;
}

double MemoryEstimate::PeakMb() const {
  return std::max({mesh_mb, photometric_mb, export_mb});
}

MemoryEstimate EstimateMemory(const ReconstructOptions& options,
                              const SceneSize& size,
                              ImagePlace place) {
  const PhotometricOptions& p = options.photometric;
  const double pixels = static_cast<double>(size.keyframes) * size.image_pixels;
  const bool keeps_luma = p.solver.trace_rms_grey && p.smoothing_sigma_px > 0;
  const double float_bytes = kSmoothBytes + (keeps_luma ? kLumaBytes : 0);
  // The first coarser level of the pyramid, made while the second is solved.
  const double coarse_share = p.levels > 2 ? 0.3125 : p.levels > 1 ? 0.25 : 0;
  const double coarse_bytes = coarse_share * (kColorBytes + float_bytes);
  const double all_mb = (kColorBytes + kDepthBytes) * pixels / kMb;
  const double all_floats_mb = (float_bytes + coarse_bytes) * pixels / kMb;
  double images_mb = all_mb, floats_mb = all_floats_mb, painted_mb = all_mb;
  if (place == ImagePlace::kFile) {
    images_mb = kWorkBytes * NumThreads() * size.image_pixels / kMb;
    floats_mb = ReadsAllImagesAtOnce(p) ? kSmoothBytes * pixels / kMb : 0;
    painted_mb = images_mb + kSeenShare * kColorBytes * pixels / kMb;
  }
  const double kept = kBaseMb + kBytesPerKeptFace * size.faces / kMb;
  const double texel = options.atlas.texel_size_m;
  const double texels = size.area_m2 / (texel * texel);
  const double views = std::max(1.0, kSeenShare * size.keyframes);
  const double pairs = std::pow(static_cast<double>(size.keyframes), 2);
  double sampled = texels / std::max(1, p.stride * p.stride);
  if (p.stride == 0) {
    sampled = std::min(sampled, p.max_observations / views);
  }
  MemoryEstimate estimate;
  // Images are read meanwhile.
  estimate.mesh_mb = kBaseMb + kBytesPerFace * size.faces / kMb + images_mb;
  estimate.drawing_mb = kDrawingMb + kBytesPerDrawnFace * size.faces / kMb;
  estimate.photometric_mb =
      kept + images_mb + kSolverMb + floats_mb + kBytesPerPair * pairs / kMb +
      sampled * (kBytesPerSampledTexel + kBytesPerObservation * views) / kMb;
  estimate.export_mb = kept + painted_mb + kBytesPerAtlasTexel * texels / kMb;
  if (place == ImagePlace::kFile) estimate.file_mb = all_mb + all_floats_mb;
  return estimate;
}

ImagePlace FitIntoMemory(const ReconstructOptions& options,
                         const SceneSize& size) {
  const double limit_mb = 1024 * options.max_memory_gb;
  double least_mb = 0;
  for (const ImagePlace place : {ImagePlace::kMemory, ImagePlace::kFile}) {
    least_mb = EstimateMemory(options, size, place).PeakMb();
    if (!(limit_mb > 0) || least_mb <= limit_mb) return place;
  }
  char text[300];
  std::snprintf(text,
                sizeof(text),
                "about %.2f GB are needed even with the images in a file, more "
                "than --max_memory_gb=%.6g: use a coarser mesh, a larger "
                "--texel_size, or a smaller --max_observations",
                least_mb / 1024,
                options.max_memory_gb);
  throw OptionsError(text);
}

std::string DescribePlan(const SceneSize& size,
                         const MemoryEstimate& estimate,
                         double available_mb) {
  char text[400];
  if (available_mb > 0 && estimate.PeakMb() > available_mb) {
    std::snprintf(text,
                  sizeof(text),
                  "about %.0f MB of memory are needed (mesh %.0f, optimisation "
                  "%.0f, export %.0f) but only %.0f MB are available: use a "
                  "coarser mesh, a larger --keyframe_window or --texel_size, "
                  "or a smaller --max_observations",
                  estimate.PeakMb(),
                  estimate.mesh_mb,
                  estimate.photometric_mb,
                  estimate.export_mb,
                  available_mb);
    AddWarning(text);
  }
  std::snprintf(text,
                sizeof(text),
                "%zu faces, %.1f m2, up to %zu keyframes: about %.0f MB",
                size.faces,
                size.area_m2,
                size.keyframes,
                estimate.PeakMb());
  if (!(estimate.file_mb > 0)) return text;
  return text + (", images in a scratch file of " +
                 std::to_string(std::lround(estimate.file_mb)) + " MB");
}

void WarnOfConventions(const RgbdSequence& sequence,
                       const TriMesh& mesh,
                       const VisibilityOptions& visibility) {
  if (!visibility.test_sensor_depth || visibility.allow_missing_depth) return;
  const InputCheck check = CheckInput(sequence, mesh, InputCheckOptions());
  if (check.given_fits) return;
  AddWarning(check.verdict +
             " The model will be poor: facet-check-input tells more.");
}

}  // namespace facet
