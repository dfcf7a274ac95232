// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Do scan and mesh belong together under the conventions given? The mesh is
// rendered into a few frames under every plausible reading of the pose files
// and of the depth unit, and compared with the sensor depth: the right reading
// agrees to centimetres, a wrong one by chance only.
//
//   readings = {camera-to-world, world-to-camera}
//            x {camera axes y down z forward, y up z backward (OpenGL)}
//            x {depth shift as given, 1000, 5000, 256, estimated}
//
// The estimated shift makes the median of mesh depth over sensor depth 1.
#pragma once

#include <string>
#include <vector>

#include "mesh/tri_mesh.h"
#include "rgbd/sequence.h"

namespace facet {

struct InputCheckOptions {
  int num_frames = 8;          // spread evenly over the usable ones
  int pixel_step = 4;          // every 4th depth pixel along x and y
  double tolerance_m = 0.05;   // |z - D| below this agrees [m]
  double min_agreement = 0.5;  // share that a right reading reaches
};

// One reading of the input, and how well it fits.
struct Reading {
  bool inverse_pose = false;  // pose files hold world-to-camera
  bool opengl_axes = false;   // their camera has y up, z backward
  double depth_shift = 1000;  // raw units a metre
  bool estimated_shift = false;
  size_t depth_pixels = 0;  // with sensor depth
  size_t hits = 0;          // of these, where the mesh is hit
  size_t agreeing = 0;      // of these, |z - D| < tolerance

  // Share of the sensor depth that the mesh covers, and share of that which
  // agrees; 0 without any.
  double Coverage() const;
  double Agreement() const;
};

struct InputCheck {
  std::vector<int> frames;        // indices of the frames compared
  double depth_share = 0;         // pixels with sensor depth, all frames
  std::vector<Reading> readings;  // [0] is the one given
  int best = 0;                   // most agreeing pixels; the given one on ties
  bool given_fits = false;        // conventions and orientation of the mesh
  // Share of the mesh's pixels, under the best reading, whose face is seen from
  // behind: a mesh that is inside out cannot be textured.
  double behind_share = 0;
  // One sentence: which reading fits and what to change.
  std::string verdict;
};

// The depth range of the sequence's options does not matter. Throws InputError
// if no frame can be read, UnsolvableError if none of them
// has any depth.
InputCheck CheckInput(const RgbdSequence& sequence,
                      const TriMesh& mesh,
                      const InputCheckOptions& options);

// "inverse pose, OpenGL axes", "pose as given", ...
std::string DescribePoses(const Reading& reading);

}  // namespace facet
