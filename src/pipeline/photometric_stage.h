// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The photometric stage: atlas, texels, visibility, then the schedule that
// minimises E_tex (method ch. 4, 6, 7).
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "mesh/planar_partition.h"
#include "mesh/tri_mesh.h"
#include "problems/exposure_calibration.h"
#include "problems/texture_problem.h"
#include "rgbd/sequence.h"
#include "schedule/run_schedule.h"
#include "terms/term_kinds.h"
#include "texture/atlas.h"
#include "texture/keyframe_images.h"
#include "texture/observations.h"

namespace facet {

struct PhotometricOptions {
  // Every stride-th texel in both directions takes part in the optimisation.
  // 0 = the smallest stride that keeps the observations below
  // max_observations. Paper: 1.
  int stride = 0;
  size_t max_observations = 7000000;
  double edge_margin_m = TexelOptions().edge_margin_m;  // texture/texels.h
  int tile_texels = 16;  // side of the square tiles (SortTexelsIntoTiles)
  double smoothing_sigma_px = 0.8;        // Gaussian on the luma; paper: none
  int warp_columns = 20, warp_rows = 16;  // control vertices (paper)
  // Coarse-to-fine: pyramid levels with images halved and the stride doubled a
  // level (method, Sec. 10.3 (i)). Coarse levels run the schedule without
  // warps, on observations of their own, and are left out where images would be
  // smaller than 24 px; 1 = none.
  int levels = 3;
  // A joint solve of poses, planes and colours first, without warp, then the
  // warps (docs/ablations.md). The paper: 10x[C; Phi; T+F].
  std::string schedule = "C+Phi+T; F; C";
  // Bring the keyframes to a common exposure first (texture/exposure.h); off in
  // the paper.
  bool exposure = true;
  ExposureOptions exposure_calibration;
  StopRule stop;
  Formulation formulation;
  SolverConfig solver;
  EnergyWeights weights;            // lambda1 and texel_weight are computed
  std::vector<WeightedTerm> terms;  // beside the paper's
};

struct PhotometricResult {
  std::vector<Pose> cam_from_world;  // colour camera, a keyframe
  std::vector<Plane> planes;
  std::vector<double> warps;  // empty if all are zero
  WarpLattice lattice;
  EnergyTerms initial, final_terms;
  ExposureCalibration exposure;  // no exposures: not calibrated
  double lambda1 = 0;
  int stride = 0;
  size_t texels = 0, texels_observed = 0;
  std::string observation_fingerprint;  // texture/fingerprint.h
  VisibilityCounts visibility;
  Trace trace;
  std::vector<size_t> plane_texels, plane_frames;  // observed, by plane
};

// `planes` are the initial planes, one a cluster. `surface`, one a cluster or
// empty: TextureProblem::surface. `cam_from_world` are the
// initial poses of the colour camera, one a keyframe. `keyframe_images` come
// with their colours; exposures, if they are calibrated, and float images are
// set. Prints the fixed-width table of the phases through `print` (one line a
// call).
PhotometricResult RunPhotometricStage(
    const TriMesh& mesh,
    const PlanarPartition& partition,
    const std::vector<Plane>& planes,
    const std::vector<SurfaceMoments>& surface,
    const Atlas& atlas,
    const RgbdSequence& sequence,
    const std::vector<int>& keyframes,
    const std::vector<Pose>& cam_from_world,
    const VisibilityOptions& visibility,
    const PhotometricOptions& options,
    KeyframeImages* keyframe_images,
    const std::function<void(const std::string&)>& print);

}  // namespace facet
