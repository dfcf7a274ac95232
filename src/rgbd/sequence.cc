// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "rgbd/sequence.h"

#include <filesystem>

#include "rgbd/dataset_bundlefusion.h"
#include "util/errors.h"

namespace facet {

cv::Mat RgbdSequence::LoadLuma(int frame_idx) const {
  return LumaFromRgb(LoadColor(frame_idx));
}

std::vector<Pose> RgbdSequence::ColorPoses(
    const std::vector<int>& frame_idx) const {
  std::vector<Pose> poses;
  for (const int i : frame_idx) poses.push_back(color_cam_from_world(i));
  return poses;
}

std::vector<int> RgbdSequence::Numbers(
    const std::vector<int>& frame_idx) const {
  std::vector<int> numbers;
  for (const int i : frame_idx) numbers.push_back(frames_[i].number);
  return numbers;
}

Pose RgbdSequence::PoseFileFromColorCam(
    const Pose& color_cam_from_world) const {
  if (options_.pose_camera == PoseCamera::kColor) {
    return color_cam_from_world.Inverse();
  }
  return color_cam_from_world.Inverse() * calibration_.color_from_depth;
}

Pose RgbdSequence::ColorCamFromPoseFile(const Pose& world_from_cam) const {
  if (options_.pose_camera == PoseCamera::kColor) {
    return world_from_cam.Inverse();
  }
  return calibration_.color_from_depth * world_from_cam.Inverse();
}

std::unique_ptr<RgbdSequence> OpenSequence(const std::string& path,
                                           const SequenceOptions& options) {
  if (!(options.min_depth_m >= 0 &&
        options.min_depth_m < options.max_depth_m)) {
    throw OptionsError(
        "the depth range must satisfy 0 <= --min_depth < --max_depth");
  }
  if (!std::filesystem::is_directory(path)) {
    throw InputError("sequence folder '" + path +
                     "' does not exist: give the folder that holds the "
                     "frames");
  }
  return OpenBundleFusionFolder(path, options);
}

cv::Mat LumaFromRgb(const cv::Mat& rgb,
                    const Eigen::Array3f& gain,
                    const Eigen::Array3f& offset) {
  cv::Mat luma(rgb.size(), CV_32F);
  const Eigen::Array3f weights(0.299f, 0.587f, 0.114f);
  const float base = (weights * offset).sum();
  const float r = weights[0] / 255 * gain[0], g = weights[1] / 255 * gain[1],
              b = weights[2] / 255 * gain[2];
  // Apart, so that the loop can be vectorised.
  cv::Mat channels[3];
  cv::split(rgb, channels);
  for (int y = 0; y < rgb.rows; ++y) {
    const uint8_t* red = channels[0].ptr<uint8_t>(y);
    const uint8_t* green = channels[1].ptr<uint8_t>(y);
    const uint8_t* blue = channels[2].ptr<uint8_t>(y);
    float* out = luma.ptr<float>(y);
    for (int x = 0; x < rgb.cols; ++x) {
      out[x] = r * red[x] + g * green[x] + b * blue[x] + base;
    }
  }
  return luma;
}

}  // namespace facet
