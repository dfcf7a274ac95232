// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// What the photometric optimisation works on: the constant part
// (TextureProblem) and the unknowns (ReconState).
#pragma once

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

#include "costs/photo_kernel.h"
#include "geometry/image_view.h"
#include "geometry/pinhole.h"
#include "geometry/plane.h"
#include "geometry/pose.h"
#include "geometry/warp_grid.h"
#include "mesh/covariance.h"
#include "problems/formulation.h"
#include "problems/term.h"
#include "texture/depth_moments.h"
#include "texture/observations.h"
#include "texture/texels.h"

namespace facet {

struct SampledImage;  // geometry/image_sampler.h

// The unknowns, in flat double arrays with stable addresses: Ceres optimises
// them in place. Copyable: every schedule of a comparison starts from a copy.
struct ReconState {
  std::vector<double> poses;   // 7 a keyframe, layout of costs/se3_manifold.h
  std::vector<double> planes;  // 4 a plane: n, d about its anchor
  std::vector<double> warps;   // 2 * vertices a keyframe [px]; zeros = no warp
  std::vector<float> colors;   // 1 a texel in [0, 1], channel by channel

  Pose CamFromWorld(int keyframe) const;
  // n.x + w = 0 with w = d - n.c.
  Plane PlaneAt(int plane, const Eigen::Vector3d& anchor) const;
};

// Consecutive texels of one plane, at most kTileTexels: the unit of parallel
// work whose partial sums are added in order, and the patch on which the joint
// solve takes viewing directions as constant (problems/joint_pass.h).
struct TexelTile {
  int plane = 0;
  size_t texel_begin = 0, texel_end = 0;
  size_t segment_begin = 0, segment_end = 0;  // into TextureProblem::segments
};
inline constexpr size_t kTileTexels = 4096;

// Observations of a tile's texels by one keyframe: texel ids
// observations.texel[begin .. end).
struct TileSegment {
  int keyframe = 0;
  size_t begin = 0, end = 0;
};

// Everything that stays constant while poses, planes, warps and colours move.
struct TextureProblem {
  Formulation formulation;
  Pinhole camera;  // of the colour images
  WarpLattice lattice;
  std::vector<ImageView<float>> images;  // luma or red, pre-smoothed: E_c
  // Channels::kRgb: green, then blue images.
  std::vector<std::vector<ImageView<float>>> more_images;
  std::vector<ImageView<float>> raw_images;  // luma, unsmoothed: rms_grey
  // If set, called when the images of a keyframe have been read for now, from
  // any thread, to release their memory (rgbd/image_store.h).
  std::function<void(int keyframe)> release_images;
  TexelSet texels;
  Observations observations;
  std::vector<TexelTile> tiles;
  std::vector<TileSegment> segments;  // by tile, ascending keyframe
  // The segments of keyframe k by ascending tile: indices
  // keyframe_segments[keyframe_segment_begin[k] .. [k + 1]).
  std::vector<uint32_t> keyframe_segments;
  std::vector<size_t> keyframe_segment_begin;
  std::vector<size_t> plane_tile_begin;  // planes + 1: tiles of each plane
  std::vector<Eigen::Vector3d> anchors;  // of the planes, world [m]
  // What E_p holds the planes to: their surface in the dense mesh, counted like
  // `texels_per_m2` texels; empty = the texels themselves, as in the paper. The
  // light mesh strays from the dense one by more than planes move.
  std::vector<SurfaceMoments> surface;
  double texels_per_m2 = 0;
  std::vector<Eigen::Matrix4d> moments;      // of costs/plane_moment.h, a plane
  std::vector<size_t> plane_texels;          // observed texels of each plane
  std::vector<uint16_t> views;               // keyframes that see each texel
  std::vector<DepthMoment> depth_moments;    // may be empty: no E_d
  std::vector<Pose> initial_cam_from_world;  // centre of the pose prior
  std::vector<Term> terms;                   // beside prior and E_d
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  // of float coordinates
  // Sampling::kScharr: gradients of all images, channel by channel.
  std::vector<std::vector<float>> gradients_x, gradients_y;

  int NumChannels() const { return 1 + static_cast<int>(more_images.size()); }
  const ImageView<float>& Image(int channel, int keyframe) const {
    return channel == 0 ? images[keyframe] : more_images[channel - 1][keyframe];
  }
  void ReleaseImages(int keyframe) const {
    if (release_images) release_images(keyframe);
  }
  int NumKeyframes() const { return static_cast<int>(images.size()); }
  int NumPlanes() const { return static_cast<int>(anchors.size()); }
};

// Reorders texels within their planes so that squares of `size` x `size` texels
// are consecutive, and returns these tiles (without segments). Call before the
// observations are computed.
std::vector<TexelTile> SortTexelsIntoTiles(
    const std::vector<Plane>& planes,
    const std::vector<Eigen::Vector3d>& anchors,
    int size,
    TexelSet* texels);

// Builds the derived tables (segments, moments, views) from cameras, images,
// texels, observations and anchors, which must be set. Without tiles, runs of
// kTileTexels texels are taken.
void FinishTextureProblem(TextureProblem* problem);

// The state at the start: given poses and planes, no warp, mean colours.
ReconState InitialState(const TextureProblem& problem,
                        const std::vector<Plane>& planes);

// Keyframes in the kernel's form for the current state. `warps` receives float
// copies that must live as long as the result. raw = unsmoothed luma, always
// bilinear, clamped and squared: what variants are compared by.
std::vector<PhotoFrame> MakePhotoFrames(const TextureProblem& problem,
                                        const ReconState& state,
                                        bool raw,
                                        std::vector<float>* warps,
                                        int channel = 0);

// Kernel texels at the plane points q (planes of the state), colours of the
// channel included.
std::vector<PhotoTexel> PlanePoints(const TextureProblem& problem,
                                    const ReconState& state,
                                    int channel = 0);
// Kernel texels at the mesh points p, colours of the channel included.
std::vector<PhotoTexel> MeshPoints(const TextureProblem& problem,
                                   const ReconState& state,
                                   int channel = 0);

// What the kernel reads for one channel of E_c.
struct PhotoChannel {
  std::vector<float> warps;
  std::vector<PhotoFrame> frames;
  std::vector<PhotoTexel> points;
};

enum class PointsAt { kPlane, kMesh };
// One channel; `raw` as in MakePhotoFrames.
PhotoChannel MakePhotoChannel(const TextureProblem& problem,
                              const ReconState& state,
                              PointsAt points,
                              bool raw,
                              int channel);
// All channels of E_c.
std::vector<PhotoChannel> MakePhotoChannels(const TextureProblem& problem,
                                            const ReconState& state,
                                            PointsAt points);

// An image with its gradients, for the double reference.
SampledImage SampledImageOf(const TextureProblem& problem,
                            int channel,
                            int keyframe);

}  // namespace facet
