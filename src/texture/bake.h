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
// median: highlights, people, misregistered edges. The defaults are the plain
// mean of the authors' code but for the ramp: on real scans every weight tried
// made held-out views match worse (docs/design.md).
#pragma once

#include <opencv2/core.hpp>
#include <vector>

#include "geometry/warp_grid.h"
#include "mesh/planar_partition.h"
#include "mesh/tri_mesh.h"
#include "render/ray_scene.h"
#include "rgbd/sequence.h"
#include "texture/atlas.h"
#include "texture/keyframe_images.h"
#include "texture/observations.h"

namespace facet {

enum class BakeSampler {
  kBilinear,  // of the authors' code
  kBicubic,   // Catmull-Rom: a little sharper where a texel is below a pixel
};

struct BakeOptions {
  double angle_power = 0;         // a >= 0
  double depth_power = 0;         // b >= 0
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
  int ring_px = 4;      // gutter coloured from the images; the rest is copied
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

// Pages of the atlas, CV_8UC3 in RGB order.
//   mesh       final vertices; its faces and vertex colours (0-255, optional:
//              they guide the filling of unseen texels)
//   planes     final planes by cluster id; colours are looked up at the plane
//              point q, on steep charts at the mesh point p
//   scene      the same mesh, for occlusion
//   keyframes  indices into sequence.frames(), as in `images`
//   color_cam_from_world, warps  by keyframe: pose; 2 * lattice.NumVertices()
//              doubles [px]. `warps` may be empty.
//   report     may be null
//   only_faces by face, empty = all: texels of tiles without such a face count
//   as
//              unseen, which saves their time
// Same result at any number of threads.
std::vector<cv::Mat> BakeTexture(const TriMesh& mesh,
                                 const std::vector<Plane>& planes,
                                 const Atlas& atlas,
                                 const RayScene& scene,
                                 const RgbdSequence& sequence,
                                 const std::vector<int>& keyframes,
                                 const KeyframeImages& images,
                                 const std::vector<Pose>& color_cam_from_world,
                                 const WarpLattice& lattice,
                                 const std::vector<double>& warps,
                                 const VisibilityOptions& visibility,
                                 const BakeOptions& options,
                                 BakeReport* report = nullptr,
                                 const std::vector<char>& only_faces = {});

}  // namespace facet
