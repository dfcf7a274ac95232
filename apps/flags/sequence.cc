// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "apps/flags/sequence.h"

#include <gflags/gflags.h>

#include "util/errors.h"

DEFINE_string(sequence,
              "",
              "folder of the scan: frame-NNNNNN.color.jpg, .depth.png, "
              ".pose.txt and info.txt");
DEFINE_string(pose_camera,
              "depth",
              "camera that the pose files belong to: depth or color");
DEFINE_string(extrinsic_direction,
              "rig_to_cam",
              "what the extrinsics of info.txt map: rig_to_cam or cam_to_rig");
DEFINE_double(min_depth,
              facet::SequenceOptions().min_depth_m,
              "nearer depth counts as missing [m]");
DEFINE_double(max_depth,
              facet::SequenceOptions().max_depth_m,
              "farther depth counts as missing [m]");

namespace facet {
namespace {

// Is `value` the first of two choices? Throws if it is neither.
bool IsFirst(const std::string& flag,
             const std::string& value,
             const std::string& first,
             const std::string& second) {
  if (value != first && value != second) {
    throw OptionsError("--" + flag + "=" + value + ": must be " + first +
                       " or " + second);
  }
  return value == first;
}

}  // namespace

SequenceOptions SequenceOptionsFromFlags() {
  SequenceOptions options;
  options.pose_camera =
      IsFirst("pose_camera", FLAGS_pose_camera, "depth", "color")
          ? PoseCamera::kDepth
          : PoseCamera::kColor;
  options.extrinsic_direction = IsFirst("extrinsic_direction",
                                        FLAGS_extrinsic_direction,
                                        "rig_to_cam",
                                        "cam_to_rig")
                                    ? ExtrinsicDirection::kRigToCam
                                    : ExtrinsicDirection::kCamToRig;
  options.min_depth_m = FLAGS_min_depth;
  options.max_depth_m = FLAGS_max_depth;
  return options;
}

std::unique_ptr<RgbdSequence> OpenSequenceFromFlags(
    const SequenceOptions& options) {
  if (FLAGS_sequence.empty()) {
    throw OptionsError("--sequence is missing: give the folder of the scan");
  }
  return OpenSequence(FLAGS_sequence, options);
}

}  // namespace facet
