// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Exposures of the keyframes (texture/exposure.h) from what they see of the
// same texels, before anything else moves: three linear least-squares problems,
// one a channel, with the colours eliminated (costs/exposure_cost.h).
// Brightness is a matter of large areas, so initial poses are good enough.
#pragma once

#include <vector>

#include "geometry/pinhole.h"
#include "geometry/plane.h"
#include "geometry/pose.h"
#include "texture/exposure.h"
#include "texture/keyframe_images.h"
#include "texture/observations.h"

namespace facet {

struct ExposureOptions {
  // Darker and lighter samples are clipped and do not follow the model (0-1).
  double min_intensity = 0.02, max_intensity = 0.98;
  // The prior counts like this many observations, of standard deviation
  // `noise`, whose exposure strays by these standard deviations from (1, 0).
  double prior_observations = 100;
  double gain_sigma = 0.2, offset_sigma = 0.1, noise = 0.05;
  // No camera does more; a gain beyond [1 / max_gain, max_gain] says that the
  // keyframe's pose or image is wrong, and the keyframe stays as taken.
  double max_gain = 4;
};

struct ExposureCalibration {
  std::vector<Exposure> exposures;  // by keyframe; (1, 0) where nothing is seen
  size_t samples = 0;
  // Root mean square of a sample minus the mean of its texel, over texels and
  // channels, 0-255: as taken, and with the exposures applied.
  double rms_before = 0, rms_after = 0;
  // Over keyframes and channels: the spread of what a grey of 0.5 becomes.
  double min_grey = 0, max_grey = 0;
};

// Colours are looked up at the plane points q. Of a texel seen by fewer than
// two keyframes nothing is learnt. Warns of keyframes with an impossible gain,
// and leaves all as taken, with a warning, if there is no solution. Same result
// at any number of threads.
ExposureCalibration CalibrateExposures(const TexelSet& texels,
                                       const Observations& observations,
                                       const std::vector<Plane>& planes,
                                       const Pinhole& camera,
                                       const std::vector<Pose>& cam_from_world,
                                       const KeyframeImages& images,
                                       const ExposureOptions& options);

}  // namespace facet
