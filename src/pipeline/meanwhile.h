// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// What a run does while its mesh stages, which are serial for long, leave
// threads idle: images are read, and the dense mesh is drawn.
#pragma once

#include <memory>
#include <vector>

#include "pipeline/artefacts.h"
#include "pipeline/config.h"
#include "render/preview_views.h"
#include "rgbd/keyframes.h"
#include "rgbd/sequence.h"
#include "texture/keyframe_images.h"
#include "util/background.h"

namespace facet {

class Meanwhile {
 public:
  // Begins nothing yet. Options and sequence must outlive it.
  Meanwhile(const ReconstructOptions& options, const RgbdSequence& sequence)
      : options_(options), sequence_(sequence) {}

  // Begins to choose the keyframes, and to decode them if the run goes so far
  // as to need them. They are held in `store`.
  void ReadImages(const ImageStore& store);

  // Wait for them. Throw as ChooseKeyframes and LoadKeyframeColors. Keyframes
  // are there after ReadImages only; without it, or taken already, the colours
  // are empty.
  const KeyframeChoice& Keyframes();
  KeyframeImages TakeColors();

  // Begins to write the pictures of the dense mesh, seen from near the given
  // poses of the colour camera. Does nothing if the run writes none, or if they
  // are being drawn already. `dense` must outlive this.
  void DrawDense(const MeshArtefact& dense,
                 const std::vector<Pose>& cam_from_world);

  // Waits for them and returns where they were taken from.
  std::vector<PreviewView> Views();

 private:
  const ReconstructOptions& options_;
  const RgbdSequence& sequence_;
  KeyframeChoice choice_;
  KeyframeImages images_;
  std::vector<PreviewView> views_;
  // Last, so that they are over before what they write to is gone.
  std::unique_ptr<Background> reading_, drawing_;
};

}  // namespace facet
