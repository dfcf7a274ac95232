// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include "pipeline/export_stage.h"
#include "tests/rgbd/tiny_sequence.h"

namespace facet {
namespace {

double Distance(const Pose& a, const Pose& b) {
  return (a.Matrix() - b.Matrix()).norm();
}

// Whatever camera the pose files belong to: without a change the poses come
// back as they were, of keyframes and of others. Breaks if poses.txt holds the
// colour camera while the files hold the depth camera.
TEST(RunPoses, UnchangedPosesComeBack) {
  const TinySequence scan({2, 3, 7, 8, 20});
  for (const PoseCamera camera : {PoseCamera::kDepth, PoseCamera::kColor}) {
    SequenceOptions options;
    options.pose_camera = camera;
    const auto sequence = OpenSequence(scan.path(), options);
    const std::vector<int> keyframes = {1, 3};
    const std::vector<NumberedPose> poses =
        RunPoses(*sequence, keyframes, sequence->ColorPoses(keyframes));
    ASSERT_EQ(poses.size(), 5u);
    for (const NumberedPose& p : poses) {
      EXPECT_LT(
          Distance(p.world_from_cam, TinySequence::WorldFromCam(p.number)),
          1e-8)
          << p.number;
    }
  }
}

// The same motion of the world at every keyframe moves all frames by it: before
// the first, between, and after the last. Breaks if corrections are
// interpolated on the wrong side of the poses.
TEST(RunPoses, CommonMotionMovesAllFrames) {
  const TinySequence scan({0, 1, 4, 5, 9});
  const auto sequence = OpenSequence(scan.path(), {});
  const std::vector<int> keyframes = {1, 3};
  std::vector<Pose> moved = sequence->ColorPoses(keyframes);
  const Pose camera_motion =
      ExpSe3((Vector6d() << 0.02, -0.01, 0.03, 0.04, 0.01, -0.02).finished());
  for (Pose& pose : moved) pose = camera_motion * pose;
  const std::vector<NumberedPose> poses = RunPoses(*sequence, keyframes, moved);
  for (size_t i = 0; i < poses.size(); ++i) {
    const Pose expected = sequence->PoseFileFromColorCam(
        camera_motion * sequence->color_cam_from_world(static_cast<int>(i)));
    EXPECT_LT(Distance(poses[i].world_from_cam, expected), 1e-9) << i;
  }
}

// Frames without a pose are left out, and do not shift the others.
TEST(RunPoses, LostFramesAreLeftOut) {
  const TinySequence scan({0, 1, 2, 3, 4, 5});
  scan.Write("frame-000001.pose.txt",
             "-inf -inf -inf -inf\n-inf -inf -inf -inf\n"
             "-inf -inf -inf -inf\n-inf -inf -inf -inf\n");
  const auto sequence = OpenSequence(scan.path(), {});
  const std::vector<int> keyframes = {2, 4};
  std::vector<Pose> moved = sequence->ColorPoses(keyframes);
  moved[0].translation.x() += 0.1;
  const std::vector<NumberedPose> poses = RunPoses(*sequence, keyframes, moved);
  ASSERT_EQ(poses.size(), 5u);
  EXPECT_EQ(poses[1].number, 2);
  EXPECT_LT(Distance(poses[1].world_from_cam,
                     sequence->PoseFileFromColorCam(moved[0])),
            1e-9);
  // Frame 3 lies halfway, frame 5 beyond the last keyframe.
  Pose halfway = sequence->color_cam_from_world(3);
  halfway.translation.x() += 0.05;
  EXPECT_LT(Distance(poses[2].world_from_cam,
                     sequence->PoseFileFromColorCam(halfway)),
            1e-9);
  EXPECT_LT(Distance(poses[4].world_from_cam, TinySequence::WorldFromCam(5)),
            1e-8);
}

}  // namespace
}  // namespace facet
