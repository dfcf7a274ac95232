// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "rgbd/trajectory_io.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "tests/support/temp_dir.h"
#include "util/atomic_file.h"
#include "util/errors.h"
#include "util/random.h"

namespace facet {
namespace {

Pose RandomPose(Random* random, double size) {
  Vector6d xi;
  for (int i = 0; i < 6; ++i) xi[i] = size * random->Normal();
  return ExpSe3(xi);
}

double Difference(const Pose& a, const Pose& b) {
  return (a.Matrix() - b.Matrix()).norm();
}

TEST(Poses, RoundTrip) {
  const TempDir dir;
  Random random(1);
  std::vector<NumberedPose> poses;
  for (int i = 0; i < 20; ++i) poses.push_back({3 * i, RandomPose(&random, 1)});
  WritePoses(dir / "poses.txt", poses);
  const auto read = ReadPoses(dir / "poses.txt");
  ASSERT_EQ(read.size(), poses.size());
  for (size_t i = 0; i < poses.size(); ++i) {
    EXPECT_EQ(read[i].number, poses[i].number);
    EXPECT_LT(Difference(read[i].world_from_cam, poses[i].world_from_cam),
              1e-10);
  }
}

// Row-major: the translation stands at the 4th, 8th and 12th number.
TEST(Poses, MatrixIsRowMajor) {
  const TempDir dir;
  WritePoses(dir / "poses.txt",
             {{5, Pose(Eigen::Quaterniond::Identity(), {1, 2, 3})}});
  EXPECT_EQ(ReadFile(dir / "poses.txt"), "5 1 0 0 1 0 1 0 2 0 0 1 3 0 0 0 1\n");
}

TEST(Poses, MalformedFilesAreErrors) {
  const TempDir dir;
  const std::string good = "5 1 0 0 1 0 1 0 2 0 0 1 3 0 0 0 1\n";
  for (const std::string& text :
       {std::string(""),
        std::string("# only a comment\n"),
        std::string("5 1 0 0 1\n"),
        std::string("a b c\n"),
        good + good,
        std::string("5 2 0 0 1 0 2 0 2 0 0 2 3 0 0 0 1\n"),
        std::string("5.5 1 0 0 1 0 1 0 2 0 0 1 3 0 0 0 1\n"),
        std::string("5 nan 0 0 1 0 1 0 2 0 0 1 3 0 0 0 1\n")}) {
    std::ofstream(dir / "poses.txt") << text;
    EXPECT_THROW(ReadPoses(dir / "poses.txt"), InputError) << text;
  }
  std::ofstream(dir / "poses.txt") << "# comment\n\r\n" << good;
  EXPECT_EQ(ReadPoses(dir / "poses.txt").size(), 1u);
  EXPECT_THROW(ReadPoses(dir / "missing.txt"), InputError);
}

TEST(RedwoodLog, HasFiveLinesAFrame) {
  const TempDir dir;
  WriteRedwoodLog(dir / "t.log",
                  {{7, Pose(Eigen::Quaterniond::Identity(), {1, 2, 3})}});
  EXPECT_EQ(ReadFile(dir / "t.log"),
            "7 7 8\n1 0 0 1\n0 1 0 2\n0 0 1 3\n0 0 0 1\n");
}

class Propagation : public testing::Test {
 protected:
  Propagation() {
    Random random(2);
    for (const int number : {3, 5, 6, 10, 11, 20, 30}) {
      numbers_.push_back(number);
      poses_.push_back(RandomPose(&random, 1));
    }
  }
  std::vector<int> numbers_;
  std::vector<Pose> poses_;
  const std::vector<int> keyframes_ = {1, 3, 5};
};

// Uncorrected keyframes change nothing.
TEST_F(Propagation, NoCorrectionIsTheIdentity) {
  const auto result = PropagateCorrections(
      numbers_, poses_, keyframes_, {poses_[1], poses_[3], poses_[5]});
  for (size_t i = 0; i < poses_.size(); ++i) {
    EXPECT_LT(Difference(result[i], poses_[i]), 1e-12);
  }
}

// One correction for all keyframes is one correction for all frames, also
// beyond the ends. Breaks if it is applied from the right.
TEST_F(Propagation, ACommonCorrectionCarriesOver) {
  Random random(3);
  const Pose d = RandomPose(&random, 0.3);
  const auto result =
      PropagateCorrections(numbers_,
                           poses_,
                           keyframes_,
                           {d * poses_[1], d * poses_[3], d * poses_[5]});
  for (size_t i = 0; i < poses_.size(); ++i) {
    EXPECT_LT(Difference(result[i], d * poses_[i]), 1e-12);
  }
}

// Keyframes get their own pose, bit by bit; between them the correction moves
// in proportion to the frame *number*; beyond the ends it is constant.
TEST_F(Propagation, InterpolatesByFrameNumber) {
  const auto turn = [](double angle, double x) {
    return Pose(
        Eigen::Quaterniond(Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitZ())),
        {x, 0, 0});
  };
  const std::vector<Pose> d = {turn(0, 0), turn(0.5, 1), turn(0.1, -1)};
  std::vector<Pose> corrected;
  for (int k = 0; k < 3; ++k) corrected.push_back(d[k] * poses_[keyframes_[k]]);
  const auto result =
      PropagateCorrections(numbers_, poses_, keyframes_, corrected);
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(result[keyframes_[k]].Matrix(), corrected[k].Matrix());
  }
  EXPECT_LT(Difference(result[0], d[0] * poses_[0]), 1e-12);
  EXPECT_LT(Difference(result[6], d[2] * poses_[6]), 1e-12);
  // Number 6 is 1/5 of the way from 5 to 10, number 11 1/10 from 10 to 20.
  EXPECT_LT(Difference(result[2], turn(0.1, 0.2) * poses_[2]), 1e-12);
  EXPECT_LT(Difference(result[4], turn(0.46, 0.8) * poses_[4]), 1e-12);
}

// q and -q are the same rotation: slerp must take the short way.
TEST_F(Propagation, TakesTheShortWayRound) {
  const Pose d = ExpSe3((Vector6d() << 0.2, 0.1, 0, 0, 0, 0).finished());
  std::vector<Pose> corrected;
  for (const int k : keyframes_) corrected.push_back(d * poses_[k]);
  corrected[1].rotation.coeffs() *= -1;
  const auto result =
      PropagateCorrections(numbers_, poses_, keyframes_, corrected);
  EXPECT_LT(Difference(result[2], d * poses_[2]), 1e-12);
}

}  // namespace
}  // namespace facet
