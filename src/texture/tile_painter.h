// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Colours the tiles of one state of the model. Internal to TextureBaker.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>
#include <vector>

#include "costs/photo_kernel.h"
#include "texture/bake.h"
#include "texture/bake_colors.h"

namespace facet {

class TilePainter {
 public:
  // All must outlive the painter. `points` are the q of the state, a texel.
  // Other arguments: TextureBaker.
  TilePainter(const TextureState& state,
              const Atlas& atlas,
              const Pinhole& camera,
              const WarpLattice& lattice,
              const BakeOptions& options,
              const BakeTexels& texels,
              const std::vector<Eigen::Vector3f>& points,
              const TileSights& sights);

  // Pages of the atlas. only_faces: TextureBaker::BakeAs. report may be null.
  std::vector<cv::Mat> Paint(const std::vector<char>& only_faces,
                             BakeReport* report);

 private:
  // One keyframe, ready for lookups.
  struct View {
    PhotoFrame frame;
    Eigen::Vector3f center;
    const cv::Mat* rgb = nullptr;
    ByteExposure exposure;
    float sharpness = 1;
  };
  struct TileWork;

  void MakeViews();
  void ReleaseImages() const;
  bool IsWanted(const BakeTile& tile,
                const std::vector<char>& only_faces) const;
  BakeReport Total() const;
  float Powers(const View& view, size_t texel, const Chart& chart) const;
  void FindShown(const TileSights::View& sight, TileWork* work) const;
  void LookUp(const TileSights::View& sight, TileWork* work) const;
  void Weigh(const View& view, TileWork* work) const;
  void WeighByView(const View& view, TileWork* work) const;
  void LookUpSmoothly(const View& view, TileWork* work) const;
  void ToCommonExposure(const View& view, TileWork* work) const;
  void Add(const View& view, TileWork* work) const;
  void Sum(TileWork* work, BakeReport* report) const;
  void SumRobustly(TileWork* work, BakeReport* report) const;
  void PaintTile(size_t t);

  const TextureState& state_;
  const Atlas& atlas_;
  const Pinhole& camera_;
  const WarpLattice& lattice_;
  const std::vector<float> warps_;
  const BakeOptions& options_;
  const BakeTexels& texels_;
  const std::vector<Eigen::Vector3f>& points_;
  const TileSights& sights_;
  const bool has_powers_;  // weights differ by more than the ramp
  const float exposure_share_;
  std::vector<View> views_;              // by keyframe
  std::vector<Eigen::Vector3f> colors_;  // by texel
  std::vector<uint8_t> seen_;
  std::vector<BakeReport> reports_;  // by tile
};

}  // namespace facet
