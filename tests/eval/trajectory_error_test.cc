// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "eval/trajectory_error.h"

#include <gtest/gtest.h>

#include "util/errors.h"
#include "util/random.h"

namespace facet {
namespace {

Pose SomePose(Random* random) {
  Vector6d xi;
  for (int k = 0; k < 6; ++k) xi[k] = random->Uniform(-1, 1);
  return ExpSe3(xi);
}

std::vector<NumberedPose> Walk(int count) {
  Random random(3);
  std::vector<NumberedPose> poses;
  for (int i = 0; i < count; ++i) poses.push_back({2 * i, SomePose(&random)});
  return poses;
}

// A motion applied to the whole world is found exactly, from centres that span
// space, from one camera, and from cameras in one point.
TEST(CommonMotion, RecoversARigidMotion) {
  const Pose motion =
      ExpSe3((Vector6d() << 0.01, 0.02, -0.01, 0.03, 0.01, 0).finished());
  for (const int count : {1, 2, 20}) {
    std::vector<Pose> before, after;
    for (const NumberedPose& p : Walk(count)) {
      before.push_back(p.world_from_cam.Inverse());
      after.push_back((motion * p.world_from_cam).Inverse());
    }
    const RigidMotion found = CommonMotion(before, after);
    EXPECT_LT((found.after_from_before.Matrix() - motion.Matrix()).norm(),
              1e-9);
    EXPECT_NEAR(found.deg, RotationAngle(motion) * 57.29577951, 1e-6);
    EXPECT_NEAR(CommonMotion(after, before).mm, found.mm, 1.5);
    EXPECT_NEAR(CommonMotion(before, before).mm, 0, 1e-9);
  }
  EXPECT_EQ(CommonMotion({}, {}).mm, 0);
}

// Cameras that only turn on the spot have slid, too.
TEST(CommonMotion, OrientationsCount) {
  const Eigen::Vector3d center(1, 2, 3);
  const Eigen::Quaterniond turn(
      Eigen::AngleAxisd(0.02, Eigen::Vector3d::UnitZ()));
  const Pose before = Pose(Eigen::Quaterniond::Identity(), center);
  const Pose after = Pose(turn, center);
  const RigidMotion found = CommonMotion({before.Inverse()}, {after.Inverse()});
  EXPECT_NEAR(found.deg, 0.02 * 57.29577951, 1e-6);
  EXPECT_NEAR(found.mm, 0, 1e-6);
}

// ATE does not see the world frame, RPE neither; the slide is what they hide.
TEST(TrajectoryError, IsInvariantToTheWorldFrame) {
  const std::vector<NumberedPose> truth = Walk(30);
  const Pose motion =
      ExpSe3((Vector6d() << 0.3, -0.2, 0.5, 1, 2, 3).finished());
  std::vector<NumberedPose> moved = truth;
  for (NumberedPose& p : moved) p.world_from_cam = motion * p.world_from_cam;
  const TrajectoryError e = CompareTrajectories(moved, truth, 30);
  EXPECT_EQ(e.matched, 30u);
  EXPECT_LT(e.ate.max, 1e-9);
  EXPECT_LT(e.rotation.max, 1e-5);
  EXPECT_LT(e.frame.translation.max, 1e-9);
  EXPECT_GT(e.absolute.mean, 1);
  EXPECT_NEAR(e.slide.deg, RotationAngle(motion) * 57.29577951, 1e-6);
}

// Only frames 30 numbers apart make up one second; matching is by number, in
// any order, and frames of one trajectory only are left out.
TEST(TrajectoryError, MatchesByNumber) {
  const std::vector<NumberedPose> truth = Walk(30);  // numbers 0, 2, ... 58
  std::vector<NumberedPose> estimated(truth.rbegin(), truth.rend());
  estimated.push_back({1001, Pose()});
  estimated[3].world_from_cam.translation.x() += 0.1;
  const TrajectoryError e = CompareTrajectories(estimated, truth, 30);
  EXPECT_EQ(e.matched, 30u);
  EXPECT_EQ(e.frame.translation.count, 29u);
  EXPECT_EQ(e.second.translation.count, 15u);
  EXPECT_EQ(CompareTrajectories(estimated, truth, 31).second.translation.count,
            0u);
  EXPECT_NEAR(e.absolute.max, 0.1, 1e-9);
  EXPECT_NEAR(e.absolute.rmse, 0.1 / std::sqrt(30.0), 1e-9);
  EXPECT_NEAR(e.absolute.median, 0, 1e-12);
  // One of 30 poses is off: two relative motions are.
  EXPECT_NEAR(e.frame.translation.rmse, 0.1 * std::sqrt(2.0 / 29), 1e-9);
  EXPECT_THROW(CompareTrajectories({{7, Pose()}}, {{8, Pose()}}, 30),
               InputError);
}

}  // namespace
}  // namespace facet
