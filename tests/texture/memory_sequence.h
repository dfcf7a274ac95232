// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// A sequence whose images live in memory.
#pragma once

#include <functional>
#include <opencv2/core.hpp>
#include <utility>
#include <vector>

#include "render/ray_scene.h"
#include "rgbd/sequence.h"
#include "texture/keyframe_images.h"

namespace facet {

class MemorySequence : public RgbdSequence {
 public:
  // One camera for colour and depth unless the calibration says otherwise.
  explicit MemorySequence(const RgbdCalibration& calibration) {
    calibration_ = calibration;
    path_ = "memory";
  }

  void Add(const Pose& color_cam_from_world, cv::Mat rgb, cv::Mat depth) {
    Frame frame;
    frame.number = static_cast<int>(frames_.size());
    frame.depth_cam_from_world =
        calibration_.color_from_depth.Inverse() * color_cam_from_world;
    frames_.push_back(frame);
    color_.push_back(std::move(rgb));
    depth_.push_back(std::move(depth));
  }

  // Renders a frame: depth of the mesh, colours by a function of the world
  // point (black where nothing is hit).
  void AddRendered(const TriMesh& mesh,
                   const Pose& color_cam_from_world,
                   const std::function<cv::Vec3b(const Eigen::Vector3d&)>& f) {
    const RayScene scene(mesh);
    const Pinhole& camera = calibration_.color;
    const DepthRender seen = RenderDepth(scene, camera, color_cam_from_world);
    const Pose world_from_cam = color_cam_from_world.Inverse();
    cv::Mat rgb(camera.height, camera.width, CV_8UC3, cv::Scalar(0, 0, 0));
    for (int y = 0; y < camera.height; ++y) {
      for (int x = 0; x < camera.width; ++x) {
        const float z = seen.depth[static_cast<size_t>(y) * camera.width + x];
        if (z > 0) {
          rgb.at<cv::Vec3b>(y, x) =
              f(world_from_cam * (camera.Unproject(x, y) * z));
        }
      }
    }
    const Pose depth_pose =
        calibration_.color_from_depth.Inverse() * color_cam_from_world;
    const DepthRender measured =
        RenderDepth(scene, calibration_.depth, depth_pose);
    Add(color_cam_from_world,
        rgb,
        cv::Mat(measured.height,
                measured.width,
                CV_32F,
                const_cast<float*>(measured.depth.data()))
            .clone());
  }

  cv::Mat LoadColor(int i) const override { return color_[i]; }
  cv::Mat LoadDepth(int i) const override { return depth_[i]; }
  cv::Mat& depth(int i) { return depth_[i]; }
  cv::Mat& color(int i) { return color_[i]; }

  std::vector<int> AllFrames() const {
    std::vector<int> all;
    for (size_t i = 0; i < frames_.size(); ++i) {
      all.push_back(static_cast<int>(i));
    }
    return all;
  }
  std::vector<Pose> AllPoses() const {
    std::vector<Pose> poses;
    for (int i : AllFrames()) poses.push_back(color_cam_from_world(i));
    return poses;
  }

 private:
  std::vector<cv::Mat> color_, depth_;
};

inline RgbdCalibration TestCalibration() {
  RgbdCalibration calibration;
  calibration.color = {250, 250, 159.5, 119.5, 320, 240};
  calibration.depth = {200, 200, 119.5, 89.5, 240, 180};
  calibration.color_from_depth =
      Pose(Eigen::Quaterniond::Identity(), Eigen::Vector3d(0.02, 0, 0));
  return calibration;
}

}  // namespace facet
