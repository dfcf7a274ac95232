// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "texture/bake.h"

#include <string>

#include "texture/tile_painter.h"
#include "util/errors.h"

namespace facet {
namespace {

const BakeOptions& Checked(const BakeOptions& options) {
  if (options.angle_power < 0 || options.depth_power < 0 ||
      options.sharpness_power < 0 || !(options.best_view_power > 0) ||
      options.ring_px < 0) {
    throw OptionsError(
        "powers of the texture weights must not be negative, and the best-view "
        "power must be positive");
  }
  if (!(options.local_exposure >= 0 && options.local_exposure <= 1)) {
    throw OptionsError("the share of the local exposure must be in 0 to 1");
  }
  if (options.visibility_px < 1 || options.visibility_px > kBakeTilePx) {
    throw OptionsError("texels that share a visibility test must be 1 to " +
                       std::to_string(kBakeTilePx));
  }
  return options;
}

}  // namespace

TextureBaker::TextureBaker(const TextureState& state,
                           const Atlas& atlas,
                           const RayScene& scene,
                           const RgbdSequence& sequence,
                           const std::vector<int>& keyframes,
                           const WarpLattice& lattice,
                           const VisibilityOptions& visibility,
                           const BakeOptions& options)
    : state_(state),
      atlas_(atlas),
      lattice_(lattice),
      camera_(sequence.calibration().color),
      options_(Checked(options)),
      texels_(MakeBakeTexels(state.mesh,
                             state.planes,
                             atlas,
                             options.ring_px,
                             options.visibility_px)),
      sights_(state.mesh,
              state.planes,
              atlas,
              texels_,
              scene,
              sequence,
              keyframes,
              state.color_cam_from_world,
              visibility,
              options.mild_fallback) {
  std::vector<Eigen::Vector3f>().swap(texels_.p);
}

std::vector<cv::Mat> TextureBaker::Bake(BakeReport* report) const {
  return TilePainter(state_,
                     atlas_,
                     camera_,
                     lattice_,
                     options_,
                     texels_,
                     texels_.q,
                     sights_)
      .Paint({}, report);
}

std::vector<cv::Mat> TextureBaker::BakeAs(const TextureState& state,
                                          const std::vector<char>& only_faces,
                                          BakeReport* report) const {
  const std::vector<Eigen::Vector3f> points =
      MakeBakePoints(state.mesh,
                     state.planes,
                     atlas_,
                     options_.ring_px,
                     options_.visibility_px,
                     texels_);
  return TilePainter(state,
                     atlas_,
                     camera_,
                     lattice_,
                     options_,
                     texels_,
                     points,
                     sights_)
      .Paint(only_faces, report);
}

}  // namespace facet
