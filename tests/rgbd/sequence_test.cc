// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "rgbd/sequence.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "tests/rgbd/tiny_sequence.h"
#include "util/errors.h"
#include "util/warnings.h"

namespace facet {
namespace {

double Difference(const Pose& a, const Pose& b) {
  return (a.Matrix() - b.Matrix()).norm();
}

std::unique_ptr<RgbdSequence> Open(const TinySequence& files) {
  return OpenSequence(files.path(), SequenceOptions());
}

// The message of the InputError that opening throws, "" if it does not.
std::string OpenProblem(const TinySequence& files) {
  try {
    Open(files);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}

#define EXPECT_PROBLEM(files, part)                           \
  EXPECT_NE(OpenProblem(files).find(part), std::string::npos) \
      << "got: '" << OpenProblem(files) << "'"

// Breaks if a matrix is read transposed, a pose is not inverted, or the sign
// or the order of the extrinsics is wrong.
TEST(Sequence, ReadsCalibrationAndPoses) {
  const TinySequence files;
  const auto sequence = Open(files);
  const RgbdCalibration& c = sequence->calibration();
  EXPECT_EQ(c.color.width, 40);
  EXPECT_EQ(c.color.height, 30);
  EXPECT_EQ(c.depth.width, 32);
  EXPECT_EQ(c.depth.height, 24);
  EXPECT_EQ(c.color.fx, 35);
  EXPECT_EQ(c.color.fy, 36);
  EXPECT_EQ(c.color.cx, 19.5);
  EXPECT_EQ(c.color.cy, 14.5);
  EXPECT_EQ(c.depth.fy, 31);
  EXPECT_EQ(c.depth_shift, 1000);
  EXPECT_LT(Difference(c.color_from_depth,
                       TinySequence::ColorExtrinsic() *
                           TinySequence::DepthExtrinsic().Inverse()),
            1e-7);
  ASSERT_EQ(sequence->frames().size(), 3u);
  for (int i = 0; i < 3; ++i) {
    EXPECT_LT(Difference(sequence->frames()[i].depth_cam_from_world,
                         TinySequence::WorldFromCam(i).Inverse()),
              1e-7);
  }
}

// Breaks if the pose camera or the extrinsic direction is applied on the way in
// but not on the way out.
TEST(Sequence, PosesGoBackToTheFileInEveryConvention) {
  const TinySequence files;
  for (const auto camera : {PoseCamera::kDepth, PoseCamera::kColor}) {
    for (const auto direction :
         {ExtrinsicDirection::kRigToCam, ExtrinsicDirection::kCamToRig}) {
      SequenceOptions options;
      options.pose_camera = camera;
      options.extrinsic_direction = direction;
      const auto sequence = OpenSequence(files.path(), options);
      for (int i = 0; i < 3; ++i) {
        const Pose in_file =
            sequence->PoseFileFromColorCam(sequence->color_cam_from_world(i));
        EXPECT_LT(Difference(in_file, TinySequence::WorldFromCam(i)), 1e-7);
        EXPECT_LT(Difference(sequence->ColorCamFromPoseFile(in_file),
                             sequence->color_cam_from_world(i)),
                  1e-12);
      }
    }
  }
}

// With poses of the colour camera, that one has the pose of the file.
TEST(Sequence, PoseCameraColorIsTheColorCamera) {
  const TinySequence files;
  SequenceOptions options;
  options.pose_camera = PoseCamera::kColor;
  const auto sequence = OpenSequence(files.path(), options);
  EXPECT_LT(Difference(sequence->color_cam_from_world(1),
                       TinySequence::WorldFromCam(1).Inverse()),
            1e-7);
}

// cam_to_rig extrinsics are the inverses of rig_to_cam ones.
TEST(Sequence, ExtrinsicDirectionInvertsBothMatrices) {
  const TinySequence files;
  SequenceOptions options;
  options.extrinsic_direction = ExtrinsicDirection::kCamToRig;
  const auto sequence = OpenSequence(files.path(), options);
  EXPECT_LT(Difference(sequence->calibration().color_from_depth,
                       TinySequence::ColorExtrinsic().Inverse() *
                           TinySequence::DepthExtrinsic()),
            1e-7);
}

TEST(Sequence, NumbersMayHaveGapsAndStartAnywhere) {
  const TinySequence files({7, 12, 3});
  const auto sequence = Open(files);
  ASSERT_EQ(sequence->frames().size(), 3u);
  EXPECT_EQ(sequence->frames()[0].number, 3);
  EXPECT_EQ(sequence->frames()[1].number, 7);
  EXPECT_EQ(sequence->frames()[2].number, 12);
}

// Other files in the folder, and names that only look like frames, are no
// frames.
TEST(Sequence, IgnoresForeignFiles) {
  const TinySequence files;
  files.Write("frame-.color.jpg", "");
  files.Write("frame-000009.color.txt", "");
  files.Write("frame-000009.color.jpg.part", "");
  files.Write("frame-12345678901234567890.pose.txt", "");
  files.Write("readme.md", "");
  EXPECT_EQ(Open(files)->frames().size(), 3u);
}

// Every spelling of a lost pose makes the frame unusable and is no error.
TEST(Sequence, LostPosesAreKeptButNotUsable) {
  const TinySequence files({0, 1, 2, 3, 4, 5, 6});
  const std::string tail = " 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";
  const char* first[] = {"-1.#INF", "-inf", "1.#QNAN", "nan", "-1.#IND"};
  for (int i = 0; i < 5; ++i) {
    files.Write("frame-00000" + std::to_string(i) + ".pose.txt",
                first[i] + tail);
  }
  files.WritePose(5, Eigen::Matrix4d::Zero());
  const size_t warnings = Warnings().size();
  const auto sequence = Open(files);
  ASSERT_EQ(sequence->frames().size(), 7u);
  for (int i = 0; i < 6; ++i) EXPECT_FALSE(sequence->frames()[i].usable) << i;
  EXPECT_TRUE(sequence->frames()[6].usable);
  ASSERT_EQ(Warnings().size(), warnings + 1);
  EXPECT_EQ(Warnings().back().substr(0, 6), "6 of 7");
}

TEST(Sequence, FramesWithMissingFilesAreKeptButNotUsable) {
  const TinySequence files({0, 1, 2, 3});
  files.Remove(files.FrameFile(0, "color.jpg"));
  files.Remove(files.FrameFile(1, "depth.png"));
  files.Remove(files.FrameFile(2, "pose.txt"));
  const auto sequence = Open(files);
  ASSERT_EQ(sequence->frames().size(), 4u);
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(sequence->frames()[i].usable);
  EXPECT_TRUE(sequence->frames()[3].usable);
}

// A rotation written with few digits comes back orthonormal; without the SVD
// the quaternion would not represent it.
TEST(Sequence, RoundedRotationsBecomeExact) {
  const TinySequence files;
  Eigen::Matrix4d m = TinySequence::WorldFromCam(1).Matrix();
  m = (m * 1e3).array().round().matrix() / 1e3;
  m.row(3) << 0, 0, 0, 1;
  files.WritePose(1, m);
  const Pose pose = Open(files)->frames()[1].depth_cam_from_world.Inverse();
  EXPECT_LT((pose.Matrix() - m).cwiseAbs().maxCoeff(), 2e-3);
  const Eigen::Matrix3d r = pose.RotationMatrix();
  EXPECT_LT((r * r.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-12);
}

// One bad pose among many is a warning ...
TEST(Sequence, AFewNonRigidPosesAreSkipped) {
  const TinySequence files({0, 1, 2, 3, 4, 5});
  files.WritePose(4, 1.5 * TinySequence::WorldFromCam(4).Matrix());
  const auto sequence = Open(files);
  EXPECT_FALSE(sequence->frames()[4].usable);
  EXPECT_TRUE(sequence->frames()[5].usable);
}

// ... but files that are not poses at all are an error: scaled, mirrored,
// transposed, too short, words.
TEST(Sequence, ManyNonRigidPosesAreAnError) {
  const TinySequence files;
  const Eigen::Matrix4d good = TinySequence::WorldFromCam(1).Matrix();
  Eigen::Matrix4d scaled = good, mirrored = good;
  scaled.topLeftCorner<3, 3>() *= 1.02;
  mirrored.col(0) *= -1;
  for (const Eigen::Matrix4d& bad :
       {scaled, mirrored, Eigen::Matrix4d(good.transpose())}) {
    files.WritePose(1, bad);
    EXPECT_PROBLEM(files, "frame-000001.pose.txt");
  }
  for (const char* text : {"", "1 0 0 0 0 1 0 0 0 0 1 0", "not a pose"}) {
    files.Write("frame-000001.pose.txt", text);
    EXPECT_PROBLEM(files, "frame-000001.pose.txt");
  }
}

TEST(Sequence, MissingFolderAndEmptyFolder) {
  EXPECT_THROW(OpenSequence("/does/not/exist", SequenceOptions()), InputError);
  const TempDir empty;
  EXPECT_THROW(OpenSequence(empty.path(), SequenceOptions()), InputError);
}

// The parent of the right folder is a common slip: the message helps.
TEST(Sequence, NamesTheFramesFolderBelow) {
  const TempDir dir;
  std::filesystem::create_directory(dir / "frames");
  try {
    OpenSequence(dir.path(), SequenceOptions());
    FAIL();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("/frames'?"), std::string::npos);
  }
}

TEST(Sequence, NoUsableFrameIsAnError) {
  const TinySequence files({0});
  files.Remove(files.FrameFile(0, "pose.txt"));
  EXPECT_PROBLEM(files, "no usable frame");
}

TEST(Sequence, EmptyDepthRangeIsAnOptionsError) {
  const TinySequence files;
  SequenceOptions options;
  options.min_depth_m = 3;
  options.max_depth_m = 2;
  EXPECT_THROW(OpenSequence(files.path(), options), OptionsError);
}

TEST(SensorInfo, UnderscoreNameWorks) {
  const TinySequence files;
  files.Remove(files / "info.txt");
  files.WriteInfo("_info.txt");
  EXPECT_EQ(Open(files)->calibration().color.fx, 35);
}

TEST(SensorInfo, AbsentOptionalKeysAreWarnings) {
  const TinySequence files;
  files.WriteInfo("info.txt", "m_depthShift");
  size_t warnings = Warnings().size();
  EXPECT_EQ(Open(files)->calibration().depth_shift, 1000);
  EXPECT_EQ(Warnings().size(), warnings + 1);
  files.WriteInfo("info.txt", "m_calibrationColorExtrinsic");
  warnings = Warnings().size();
  EXPECT_LT(Difference(Open(files)->calibration().color_from_depth,
                       TinySequence::DepthExtrinsic().Inverse()),
            1e-7);
  EXPECT_EQ(Warnings().size(), warnings + 1);
}

TEST(SensorInfo, AbsentRequiredKeysAreErrors) {
  const TinySequence files;
  for (const char* key : {"m_colorWidth",
                          "m_depthHeight",
                          "m_calibrationColorIntrinsic",
                          "m_calibrationDepthIntrinsic"}) {
    files.WriteInfo("info.txt", key);
    EXPECT_PROBLEM(files, key);
  }
}

// A later line wins, so a line appended to a good file damages its key.
TEST(SensorInfo, MalformedValuesAreErrors) {
  const TinySequence files;
  for (const char* line :
       {"m_colorWidth = wide",
        "m_colorWidth = -40",
        "m_colorWidth = 40.5",
        "m_colorWidth = 99999999999",
        "m_depthShift = 0",
        "m_depthShift = nan",
        "m_calibrationDepthIntrinsic = 30 0 15.5 0 31 11.5 0 0 1",
        "m_calibrationDepthIntrinsic = 0 0 15.5 0 0 31 11.5 0 0 0 1 0 0 0 0 1",
        "m_calibrationColorExtrinsic = 2 0 0 0 0 2 0 0 0 0 2 0 0 0 0 1"}) {
    files.WriteInfo("info.txt");
    std::ofstream(files / "info.txt", std::ios::app) << line << "\n";
    const std::string key = std::string(line).substr(0, 12);
    EXPECT_PROBLEM(files, key);
  }
}

TEST(SensorInfo, CameraIntrinsicsStandInForInfo) {
  const TinySequence files({0});
  files.Remove(files / "info.txt");
  EXPECT_PROBLEM(files, "camera-intrinsics.txt");
  files.Write("camera-intrinsics.txt", "585 0 320\n0 586 240\n0 0 1\n");
  EXPECT_PROBLEM(files, "differ in size");
  cv::imwrite(files.FrameFile(0, "color.jpg"),
              cv::Mat(24, 32, CV_8UC3, cv::Scalar(0, 0, 0)));
  const RgbdCalibration c = Open(files)->calibration();
  EXPECT_EQ(c.color.fx, 585);
  EXPECT_EQ(c.depth.fy, 586);
  EXPECT_EQ(c.depth.width, 32);
  EXPECT_EQ(c.depth_shift, 1000);
  EXPECT_LT(Difference(c.color_from_depth, Pose()), 1e-12);
  files.Write("camera-intrinsics.txt", "585 0 320 0 586 240");
  EXPECT_PROBLEM(files, "3x3");
}

// Sizes that disagree with info.txt are said when opening, with both sizes.
TEST(Sequence, SizesThatDisagreeAreAnError) {
  const TinySequence files;
  cv::imwrite(files.FrameFile(0, "color.jpg"),
              cv::Mat(60, 80, CV_8UC3, cv::Scalar(0, 0, 0)));
  EXPECT_PROBLEM(files, "80x60");
  files.WriteFrame(0);
  cv::imwrite(files.FrameFile(0, "depth.png"),
              cv::Mat(48, 64, CV_16U, cv::Scalar(1000)));
  EXPECT_PROBLEM(files, "32x24");
}

// A depth picture of 8 bits, or coloured, is not sensor depth.
TEST(Sequence, DepthMustHaveSixteenBits) {
  const TinySequence files;
  for (const int type : {CV_8U, CV_8UC3, CV_16UC3}) {
    for (int i = 0; i < 3; ++i) {
      cv::imwrite(files.FrameFile(i, "depth.png"),
                  cv::Mat(24, 32, type, cv::Scalar::all(100)));
    }
    EXPECT_PROBLEM(files, "16 bits");
  }
}

// The real scans open with every frame usable.
TEST(SequenceData, OpensTheRealScans) {
  const std::string root = FACET_DATA_DIR;
  if (root.empty()) GTEST_SKIP() << "FACET_DATA_DIR is not set";
  const auto kitchen =
      OpenSequence(root + "/redkitchen/frames", SequenceOptions());
  EXPECT_NEAR(
      kitchen->calibration().color_from_depth.translation.x(), -0.0226, 1e-9);
  for (const Frame& frame : kitchen->frames()) EXPECT_TRUE(frame.usable);
  EXPECT_EQ(OpenSequence(root + "/fountain/frames", SequenceOptions())
                ->frames()
                .size(),
            33u);
}

}  // namespace
}  // namespace facet
