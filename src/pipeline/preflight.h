// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// What can be told before the work: whether it fits into the memory, and
// whether scan and mesh belong together.
#pragma once

#include <string>

#include "mesh/tri_mesh.h"
#include "pipeline/config.h"
#include "rgbd/sequence.h"

namespace facet {

// What the memory depends on.
struct SceneSize {
  size_t faces = 0;         // of the dense mesh
  double area_m2 = 0;       // of its surface
  size_t keyframes = 0;     // at most so many
  size_t image_pixels = 0;  // of a colour image
};

// The keyframes are those of full windows: the numbers of usable frames that
// are not held out, divided by the window.
SceneSize MeasureScene(const ReconstructOptions& options,
                       const TriMesh& dense,
                       const RgbdSequence& sequence);

// Largest resident memory of each part of a run [MB of 2^20 bytes].
struct MemoryEstimate {
  double mesh_mb = 0;         // partition and simplification, images
  double drawing_mb = 0;      // beside it: pictures of the dense mesh
  double photometric_mb = 0;  // images, texels, observations
  double export_mb = 0;       // images, final colours, previews

  double PeakMb() const;
  // Whether these pictures may be drawn while the mesh is simplified.
  bool DrawsBesideMesh() const { return mesh_mb + drawing_mb <= PeakMb(); }
};

// A model with one factor a thing, fitted to runs of two real scans:
//   mesh         60 MB + 390 bytes a face + 5 bytes a pixel of the keyframes
//   drawing      130 MB + 100 bytes a face
//   photometric  240 MB + 70 bytes a face + 13 bytes a pixel of the keyframes
//                (9 without smoothing or rms_grey after every phase), more with
//                coarser levels + 100 bytes a sampled texel + 11 bytes an
//                observation
//   export       60 MB + 70 bytes a face + 5 bytes a pixel + 150 bytes a texel
//                of the atlas
// Texels are area / texel_size^2, sampled ones 1 / stride^2 of them, each seen
// by 15 % of the keyframes; with stride 0 the observations stay below
// max_observations. Within a factor of two where views are that dense.
MemoryEstimate EstimateMemory(const ReconstructOptions& options,
                              const SceneSize& size);

// Makes a run fit into options->max_memory_gb: without rms_grey in the trace
// but for its first and last state, unless it fits anyway. The model does not
// depend on it. Throws OptionsError if that is not enough. It is the estimate
// that is held to the limit, not the run.
void FitIntoMemory(const SceneSize& size, ReconstructOptions* options);

// "765221 faces, 80.2 m2, 184 keyframes of 640x480: ..." for the plan line.
// Raises a warning that names the flags if `estimate` is more than
// `available_mb` (0 = unknown).
std::string DescribePlan(const SceneSize& size,
                         const MemoryEstimate& estimate,
                         double available_mb);

// Renders the mesh into a few frames (eval/input_check.h) and raises a warning
// if another convention of poses or depth unit fits, or none. Without depth to
// go by (tests of the sensor depth off or lenient) it does nothing. Throws
// UnsolvableError if no frame has depth.
void WarnOfConventions(const RgbdSequence& sequence,
                       const TriMesh& mesh,
                       const VisibilityOptions& visibility);

}  // namespace facet
