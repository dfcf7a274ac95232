// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Which keyframe sees which texel of the final texture, as bits tile by tile.
// Internal to TextureBaker.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "mesh/tri_mesh.h"
#include "render/ray_scene.h"
#include "rgbd/sequence.h"
#include "texture/bake_texels.h"
#include "texture/observations.h"

namespace facet {

// Outward unit normal of a texel: of the plane on flat charts, on steep ones of
// the texel's face.
Eigen::Vector3f TexelNormal(const TriMesh& mesh,
                            const std::vector<Plane>& planes,
                            const Chart& chart,
                            const BakeTexels& texels,
                            size_t texel);

class TileSights {
 public:
  // A keyframe that sees something of a tile. Bit i - begin of the words is set
  // if it sees texel i by the tests of VisibilityOptions, that of the words
  // after NumWords() if only by the milder verdict of FrameView::Test. Set for
  // texels that are their own source only.
  struct View {
    int keyframe = 0;
    const uint64_t* words = nullptr;
  };

  // `scene` is that of the mesh. With `mild` also the milder verdicts.
  TileSights(const TriMesh& mesh,
             const std::vector<Plane>& planes,
             const Atlas& atlas,
             const BakeTexels& texels,
             const RayScene& scene,
             const RgbdSequence& sequence,
             const std::vector<int>& keyframes,
             const std::vector<Pose>& color_cam_from_world,
             const VisibilityOptions& options,
             bool mild);
  TileSights(const TileSights&) = delete;
  TileSights& operator=(const TileSights&) = delete;

  // By ascending keyframe.
  const std::vector<View>& ViewsOf(size_t tile) const { return views_[tile]; }

  static size_t NumWords(const BakeTile& tile) {
    return (tile.owned_end - tile.begin + 63) / 64;
  }

 private:
  // Of the tiles that one keyframe sees at all.
  struct FrameBits {
    std::vector<uint32_t> tile;
    std::vector<uint32_t> first_word;
    std::vector<uint64_t> words;
  };

  std::vector<FrameBits> frames_;         // by keyframe
  std::vector<std::vector<View>> views_;  // by tile
};

}  // namespace facet
