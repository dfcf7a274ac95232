// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Synthetic RGB-D scans of a furnished room with ground truth: for the demo,
// tests and benchmarks.
//
// FROZEN: figures are measured on the default SynthOptions with seeds 1-5.
// Whatever changes the pictures, depths or poses of these scans (layout, paint,
// light, path, noise, defaults) makes all figures measured before incomparable:
// do not, or measure them all again.
#pragma once

#include <cstdint>
#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "render/ray_scene.h"
#include "rgbd/camera.h"
#include "synth/baked_texture.h"
#include "synth/room.h"
#include "synth/sensor.h"

namespace facet {

struct SynthOptions {
  int num_frames = 200;
  int width = 640, height = 480;  // of both images [px]
  // Rays a pixel and axis of the colour image.
  int supersampling = 2;
  // Errors of the poses written to the frames (PerturbPoses).
  double pose_noise_mm = 0;
  double pose_noise_deg = 0;
  // Off: depth is exact up to the rounding to raw units.
  bool depth_noise = true;
  DepthSensorOptions depth_sensor;
  double color_noise_grey = 1.5;  // [0-255]
  bool exposure_drift = false;    // gain wanders by about 12 %
  bool vignetting = false;        // the corners lose 30 %
  bool motion_blur = false;       // shutter open for half the frame interval
  BakeOptions bake;
};

// A room and a camera's way through it. Frames are rendered on demand.
struct SynthScan {
  uint64_t seed = 0;
  SynthOptions options;
  SynthRoom room;
  RgbdCalibration calibration;
  // Of the depth camera, one a frame; frame numbers are 0, 1, 2, ...
  std::vector<Pose> true_poses;   // cam_from_world
  std::vector<Pose> given_poses;  // what the pose files say
  std::vector<double> gains;      // exposure of every frame
  std::shared_ptr<const RayScene> scene;
  std::vector<BakedTexture> textures;  // by surface
};

// Colour camera 2.3 cm right of the depth camera, turned by a fraction of a
// degree; intrinsics like the first Kinect's, scaled to the image size. Throws
// OptionsError: sizes or counts below 1, negative noise.
SynthScan MakeRoom(uint64_t seed, const SynthOptions& options);

// The colour image of frame i, CV_8UC3 in RGB order, before JPEG.
cv::Mat RenderSynthColor(const SynthScan& scan, int i);

// The raw depth image of frame i, CV_16U; 0 = missing.
cv::Mat RenderSynthDepth(const SynthScan& scan, int i);

// Exact colours in [0, 255], 3 floats a pixel row-major, of a camera anywhere
// in the room: no sensor noise, gain or vignetting.
std::vector<float> RenderRoom(const SynthScan& scan,
                              const Pinhole& camera,
                              const Pose& cam_from_world,
                              int supersampling);

// Throws OptionsError when WriteSynthSequence would refuse `path`; ask before
// the long work.
void CheckSynthOutput(const std::string& path, bool overwrite);

// Writes the folder layout of docs/formats.md: info.txt and for every frame
// frame-NNNNNN.{color.jpg (quality 95), depth.png, pose.txt}; beside them
// poses_true.txt (rgbd/trajectory_io.h, depth camera), mesh_true.ply (plane_id
// a face, -1 on curved things) and planes_true.json ({"planes": [{"id", "name",
// "normal", "offset", "centroid", "area"}]}, n.x + offset = 0, id = plane_id).
// A folder that holds something is refused with OptionsError unless
// `overwrite`, which removes the frames in it. All threads; the bytes do not
// depend on their number.
void WriteSynthSequence(const SynthScan& scan,
                        const std::string& path,
                        bool overwrite);

}  // namespace facet
