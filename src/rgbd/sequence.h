// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// An RGB-D sequence on disk. Images are decoded on demand and never kept.
//
// Pose convention: files store camera-to-world of one of the two cameras
// (SequenceOptions::pose_camera); in memory every frame has
// `depth_cam_from_world`, and color_cam_from_world() follows from the
// calibration. Everything photometric uses the colour camera.
#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "rgbd/camera.h"
#include "rgbd/image_store.h"

namespace facet {

struct Frame {
  int number = 0;      // as in the file name; gaps are normal
  bool usable = true;  // has a finite rigid pose and both images
  Pose depth_cam_from_world;
  std::string color_path, depth_path;
};

enum class PoseCamera { kDepth, kColor };
enum class ExtrinsicDirection { kRigToCam, kCamToRig };

struct SequenceOptions {
  // Which camera the pose files belong to: depth in 7-Scenes and ScanNet.
  PoseCamera pose_camera = PoseCamera::kDepth;
  // Direction of the two extrinsic matrices of info.txt.
  ExtrinsicDirection extrinsic_direction = ExtrinsicDirection::kRigToCam;
  // Depth outside [min, max] counts as missing [m].
  double min_depth_m = 0.3;
  double max_depth_m = 6.0;
  // Depth images are kept once they are decoded, at 2 bytes a pixel.
  bool keep_depth = false;  // see RgbdSequence::KeepDepthIn
};

class RgbdSequence {
 public:
  virtual ~RgbdSequence() = default;

  const RgbdCalibration& calibration() const { return calibration_; }
  // Sorted by frame number.
  const std::vector<Frame>& frames() const { return frames_; }
  const std::string& path() const { return path_; }
  PoseCamera pose_camera() const { return options_.pose_camera; }

  Pose color_cam_from_world(int frame_idx) const {
    return calibration_.color_from_depth *
           frames_[frame_idx].depth_cam_from_world;
  }
  // Of several frames: color_cam_from_world, and their numbers.
  std::vector<Pose> ColorPoses(const std::vector<int>& frame_idx) const;
  std::vector<int> Numbers(const std::vector<int>& frame_idx) const;
  // Back to the camera of the pose files: world_from_<pose camera>.
  Pose PoseFileFromColorCam(const Pose& color_cam_from_world) const;
  // And its inverse: color_cam_from_world of a pose in a pose file.
  Pose ColorCamFromPoseFile(const Pose& world_from_cam) const;

  // The colour image, CV_8UC3 in **RGB** order, size of calibration().color.
  // Throws InputError naming the file when it does not decode or has another
  // size.
  virtual cv::Mat LoadColor(int frame_idx) const = 0;

  // Where depth images are held with SequenceOptions::keep_depth; in memory if
  // not called. Call before the first is read.
  void KeepDepthIn(const ImageStore& store) { depth_store_ = store; }

  // Luma of the colour image, CV_32F in [0, 1], to a grey value or so: enough
  // to measure blur, and faster than by colours. Throws as LoadColor.
  virtual cv::Mat LoadLuma(int frame_idx) const;

  // Depth in metres, CV_32F, size of calibration().depth; missing = 0
  // (raw 0, raw 65535, outside the range of the options).
  virtual cv::Mat LoadDepth(int frame_idx) const = 0;

  // The same without a range, for depth in a unit that is in doubt.
  virtual cv::Mat LoadDepthOfAnyRange(int frame_idx) const {
    return LoadDepth(frame_idx);
  }

 protected:
  RgbdCalibration calibration_;
  std::vector<Frame> frames_;
  std::string path_;
  SequenceOptions options_;
  ImageStore depth_store_;
};

// Opens the folder layout of BundleFusion, 3DLite and 7-Scenes
// (rgbd/dataset_bundlefusion.h). Frames with a lost pose (non-finite or all
// zeros), a pose that is not rigid or missing files are kept but not usable;
// counted warnings say how many. Rotations are replaced by the nearest exact
// ones. Throws OptionsError for an empty depth range, InputError: no such
// folder, no frames, no calibration or a malformed one, no usable frame, more
// than 20 % of the poses not rigid, the first images undecodable or of another
// size than the calibration says.
std::unique_ptr<RgbdSequence> OpenSequence(const std::string& path,
                                           const SequenceOptions& options);

// Luma 0.299 R + 0.587 G + 0.114 B, CV_32F, of an RGB 8-bit image, in [0, 1];
// of the colours gain * rgb + offset (offset in 0-1) if these are given.
cv::Mat LumaFromRgb(const cv::Mat& rgb,
                    const Eigen::Array3f& gain = Eigen::Array3f::Ones(),
                    const Eigen::Array3f& offset = Eigen::Array3f::Zero());

}  // namespace facet
