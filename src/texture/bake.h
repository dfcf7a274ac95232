// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Final colours of the texture at full density (method, Sec. 8.6 and 4.6).
//
//   C(q) = sum_i w_i I_i(F_i(pi(T_i q))) / sum_i w_i
//   w_i  = (cos(theta)^a  z^-b  s_i^c  f)^e
//
// over the keyframes i that see the texel: theta = viewing angle, z = depth
// [m], s = sharpness of the image (1 - Crete blur, relative to the median), f =
// ramp from 0 at the image border to 1. Plain averages blur (misalignment,
// motion, distance); e > 1 leans towards the best view, e -> infinity selects
// it. A robust pass first drops samples whose luma is far from the weighted
// median: highlights, people, misregistered edges. The authors' code takes the
// plain mean, a = b = c = 0; by default a view counts by the pixels it has for
// a metre of the surface, cos(theta) / z (docs/design.md).
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "geometry/warp_grid.h"
#include "mesh/planar_partition.h"
#include "mesh/tri_mesh.h"
#include "render/ray_scene.h"
#include "rgbd/sequence.h"
#include "texture/atlas.h"
#include "texture/bake_texels.h"
#include "texture/keyframe_images.h"
#include "texture/observations.h"
#include "texture/tile_sights.h"

namespace facet {

enum class BakeSampler {
  kBilinear,  // of the authors' code
  kBicubic,   // Catmull-Rom: a little sharper where a texel is below a pixel
};

struct BakeOptions {
  double angle_power = 1;         // a >= 0
  double depth_power = 1;         // b >= 0
  double sharpness_power = 0;     // c >= 0; 0 = do not measure blur
  double best_view_power = 1;     // e > 0; all powers 0 and e 1: plain mean
  double border_feather_px = 40;  // width of the ramp f; 0 = none
  // Drop samples with a larger |luma - median|, intensities 0 to 1; 0 = keep
  // all.
  double robust_luma = 0;
  // Brightness of the texture, if the keyframes have exposures: 0 = the common
  // one everywhere, 1 = of every texel the mean of those under which it was
  // seen, which is nearer to the photos but changes where one image ends. The
  // colours are averaged at the common exposure in any case.
  double local_exposure = 0.5;
  // Texels that no keyframe sees by the tests of VisibilityOptions take colours
  // from those of the milder verdict of FrameView::Test.
  bool mild_fallback = true;
  BakeSampler sampler = BakeSampler::kBilinear;
  // Visibility is tested at one texel of a square of so many; a texel is
  // smaller than a pixel of the depth image that decides. 1 = at every texel.
  int visibility_px = 2;
  int ring_px = 2;      // gutter coloured from the images; the rest is copied
  bool inpaint = true;  // fill unseen texels; else they stay white
};

struct BakeReport {
  size_t texels = 0;                 // in faces, without gutter
  size_t seen = 0;                   // of them coloured from images
  size_t mild = 0;                   // of those by the mild fallback only
  size_t samples = 0;                // (texel, keyframe) pairs, without gutter
  size_t dropped = 0;                // of them by the robust pass
  double mean_views = 0;             // samples / seen
  std::vector<cv::Mat> unseen_mask;  // a page: CV_8U, 255 = unseen texel
};

// A state of the model to be coloured.
struct TextureState {
  const TriMesh& mesh;               // with the faces of the atlas; its vertex
                                     // colours (0-255, optional) guide the
                                     // filling of unseen texels
  const std::vector<Plane>& planes;  // by cluster id
  const KeyframeImages& images;
  const std::vector<Pose>& color_cam_from_world;  // by keyframe
  // By keyframe 2 * lattice.NumVertices() doubles [px]; may be empty.
  const std::vector<double>& warps;
};

// Colours are looked up at the plane point q, on steep charts at the mesh point
// p. Everything given must outlive the baker. Same result at any number of
// threads.
class TextureBaker {
 public:
  // Finds which keyframes see the texels of the state.
  //   scene      the state's mesh, for occlusion
  //   keyframes  indices into sequence.frames(), as in the state's images
  TextureBaker(const TextureState& state,
               const Atlas& atlas,
               const RayScene& scene,
               const RgbdSequence& sequence,
               const std::vector<int>& keyframes,
               const WarpLattice& lattice,
               const VisibilityOptions& visibility,
               const BakeOptions& options);

  // Pages of the atlas, CV_8UC3 in RGB order. `report` may be null.
  std::vector<cv::Mat> Bake(BakeReport* report = nullptr) const;

  // Pages of another state of the same model, each texel from the keyframes
  // that see it in the baker's own: two textures of the same samples.
  //   only_faces  by face, empty = all: texels of tiles without such a face
  //               count as unseen, which saves their time
  std::vector<cv::Mat> BakeAs(const TextureState& state,
                              const std::vector<char>& only_faces = {},
                              BakeReport* report = nullptr) const;

 private:
  const TextureState state_;
  const Atlas& atlas_;
  const WarpLattice& lattice_;
  const Pinhole camera_;
  const BakeOptions options_;
  BakeTexels texels_;  // without p
  const TileSights sights_;
};

}  // namespace facet
