// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "pipeline/meanwhile.h"

#include <utility>

#include "pipeline/previews.h"

namespace facet {

void Meanwhile::ReadImages(const ImageStore& store) {
  reading_ = std::make_unique<Background>([this, store] {
    choice_ = ChooseKeyframes(sequence_, options_.keyframes);
    if (options_.to_stage < Stage::kPhotometric) return;
    images_ = LoadKeyframeColors(sequence_, choice_.keyframes, store);
  });
}

const KeyframeChoice& Meanwhile::Keyframes() {
  reading_->Finish();
  return choice_;
}

KeyframeImages Meanwhile::TakeColors() {
  if (reading_) reading_->Finish();
  return std::move(images_);
}

void Meanwhile::DrawDense(const MeshArtefact& dense,
                          const std::vector<Pose>& cam_from_world) {
  if (drawing_ || !options_.previews || options_.to_stage < Stage::kExport) {
    return;
  }
  drawing_ = std::make_unique<Background>([this, &dense, cam_from_world] {
    views_ = facet::DrawDense(options_.output_path + "/previews",
                              dense.mesh,
                              dense.partition.face_cluster,
                              cam_from_world);
  });
}

std::vector<PreviewView> Meanwhile::Views() {
  if (drawing_) drawing_->Finish();
  return views_;
}

}  // namespace facet
