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

// Where the images of the keyframes are held (rgbd/image_store.h).
enum class ImagePlace { kMemory, kFile };

// Largest resident memory of each part of a run [MB of 2^20 bytes].
struct MemoryEstimate {
  double mesh_mb = 0;         // partition and simplification, images
  double drawing_mb = 0;      // beside it: pictures of the dense mesh
  double photometric_mb = 0;  // images, texels, observations
  double export_mb = 0;       // images, final colours, previews
  double file_mb = 0;         // of the disk, for images in a file

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
//                observation + 850 bytes a pair of keyframes (the Hessian)
//   export       60 MB + 70 bytes a face + 5 bytes a pixel + 150 bytes a texel
//                of the atlas
// Texels are area / texel_size^2, sampled ones 1 / stride^2 of them, each seen
// by 15 % of the keyframes; with stride 0 the observations stay below
// max_observations. Within a factor of two where views are that dense.
//
// With the images in a file a thread holds those that it works on, 40 bytes a
// pixel, and the final texture the colours that its neighbouring tiles see, of
// 15 % of the keyframes. Phases that solve planes alone, or explicit colours,
// still read all smooth images at once.
MemoryEstimate EstimateMemory(const ReconstructOptions& options,
                              const SceneSize& size,
                              ImagePlace place = ImagePlace::kMemory);

// Where images must be held for a run to fit into options.max_memory_gb: in
// memory if it fits so. No result depends on it. Throws OptionsError if a file
// is not enough either. It is the estimate that is held to the limit, not the
// run.
ImagePlace FitIntoMemory(const ReconstructOptions& options,
                         const SceneSize& size);

// "765221 faces, 80.2 m2, up to 184 keyframes: about 870 MB, images in a
// scratch file of 600 MB" for the plan line. Raises a warning that names the
// flags if `estimate` is more than `available_mb` (0 = unknown).
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
