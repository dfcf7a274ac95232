// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The folder layout of BundleFusion, 3DLite and 7-Scenes (method, Sec. 1.2):
//
//   info.txt or _info.txt            sizes, intrinsics, extrinsics, depth unit
//   frame-NNNNNN.color.{jpg,png}     8-bit RGB
//   frame-NNNNNN.depth.{png,pgm}     16-bit grey
//   frame-NNNNNN.pose.txt            4x4 camera-to-world, row-major
//
// 7-Scenes has no info.txt: a text file camera-intrinsics.txt with the 3x3
// matrix of both images takes its place; depth is in millimetres then.
#pragma once

#include <memory>
#include <string>

#include "rgbd/sequence.h"

namespace facet {

// What info.txt says.
struct SensorInfo {
  Pinhole color, depth;
  Eigen::Matrix4d color_extrinsic = Eigen::Matrix4d::Identity();
  Eigen::Matrix4d depth_extrinsic = Eigen::Matrix4d::Identity();
  double depth_shift = 1000;
};

// Parses `key = value` lines in any order; unknown keys are ignored. An absent
// m_depthShift counts as 1000 and absent extrinsics as identity, with a
// warning. Throws InputError naming file and key: absent or malformed sizes or
// intrinsics, an extrinsic that is not rigid.
SensorInfo ReadSensorInfo(const std::string& path);

// Opens such a folder; see OpenSequence.
std::unique_ptr<RgbdSequence> OpenBundleFusionFolder(
    const std::string& path, const SequenceOptions& options);

}  // namespace facet
