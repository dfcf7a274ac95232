// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "eval/input_check.h"

#include <gtest/gtest.h>

#include <functional>

#include "render/ray_scene.h"
#include "util/errors.h"

namespace facet {
namespace {

// A box without its ceiling, 4 x 3 x 2.5 m, with a block on its floor: no two
// of the readings see the same.
TriMesh Room() {
  TriMesh mesh;
  const auto add_box = [&mesh](const Eigen::Vector3d& low,
                               const Eigen::Vector3d& high) {
    const int base = static_cast<int>(mesh.vertices.size());
    for (int i = 0; i < 8; ++i) {
      mesh.vertices.emplace_back(i & 1 ? high.x() : low.x(),
                                 i & 2 ? high.y() : low.y(),
                                 i & 4 ? high.z() : low.z());
    }
    const int quads[5][4] = {
        {0, 1, 3, 2}, {4, 5, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}, {2, 3, 7, 6}};
    for (const auto& q : quads) {
      mesh.faces.push_back({base + q[0], base + q[1], base + q[2]});
      mesh.faces.push_back({base + q[0], base + q[2], base + q[3]});
    }
  };
  add_box({-1, -1.5, -1}, {3, 1, 2});
  add_box({0.5, 0.2, 0.8}, {1.4, 1, 1.6});
  return mesh;
}

// The scan of a room that says what it is told to say: true depth times
// `depth_factor`, and pose files that mean something else.
class FakeSequence : public RgbdSequence {
 public:
  explicit FakeSequence(const TriMesh& mesh, double depth_factor = 1)
      : scene_(mesh), depth_factor_(depth_factor) {
    calibration_.depth = {60, 60, 39.5, 29.5, 80, 60};
    calibration_.color = {70, 70, 49.5, 37, 100, 75};
    calibration_.color_from_depth.translation = {-0.02, 0, 0};
    calibration_.depth_shift = 1000;
    for (int i = 0; i < 10; ++i) {
      Vector6d xi;
      xi << 0.1, 0.12 * i - 0.2, 0.02 * i, 0.3 - 0.05 * i, 0.2, 0.4;
      true_poses_.push_back(ExpSe3(xi));
      Frame frame;
      frame.number = 3 * i;
      frame.depth_cam_from_world = true_poses_.back();
      frames_.push_back(frame);
    }
  }

  // What the reader makes of pose files with the given contents.
  void SayPoses(const std::function<Pose(const Pose&)>& file_from_true) {
    for (size_t i = 0; i < frames_.size(); ++i) {
      frames_[i].depth_cam_from_world =
          file_from_true(true_poses_[i].Inverse()).Inverse();
    }
  }
  void SetUnusable(int i) { frames_[i].usable = false; }

  cv::Mat LoadColor(int) const override { return {}; }
  cv::Mat LoadDepth(int i) const override {
    if (fails_) throw InputError("image does not decode");
    const DepthRender render =
        RenderDepth(scene_, calibration_.depth, true_poses_[i]);
    cv::Mat depth(60, 80, CV_32F);
    for (size_t k = 0; k < render.depth.size(); ++k) {
      depth.at<float>(static_cast<int>(k)) =
          static_cast<float>(depth_factor_ * render.depth[k]);
    }
    return depth.reshape(1, 60);
  }
  bool fails_ = false;

 private:
  RayScene scene_;
  double depth_factor_;
  std::vector<Pose> true_poses_;
};

Pose HalfTurn() {
  return Pose(Eigen::Quaterniond(0, 1, 0, 0), Eigen::Vector3d::Zero());
}

// Right input fits, wholly: noise-free depth against its own mesh.
TEST(InputCheck, RightInputFits) {
  const TriMesh room = Room();
  const InputCheck check = CheckInput(FakeSequence(room), room, {});
  EXPECT_TRUE(check.given_fits);
  EXPECT_EQ(check.best, 0);
  EXPECT_GT(check.readings[0].Agreement(), 0.99);
  EXPECT_GT(check.readings[0].Coverage(), 0.99);
  EXPECT_EQ(check.frames.size(), 8u);
}

TEST(InputCheck, FindsInversePoses) {
  const TriMesh room = Room();
  FakeSequence sequence(room);
  sequence.SayPoses([](const Pose& pose) { return pose.Inverse(); });
  const InputCheck check = CheckInput(sequence, room, {});
  EXPECT_FALSE(check.given_fits);
  EXPECT_TRUE(check.readings[check.best].inverse_pose);
  EXPECT_FALSE(check.readings[check.best].opengl_axes);
  EXPECT_NE(check.verdict.find("world-to-camera"), std::string::npos);
  EXPECT_EQ(check.verdict.find("m_depthShift"), std::string::npos);
}

// Camera-to-world of a camera with y up and z backward; and its inverse.
TEST(InputCheck, FindsOpenGlAxes) {
  const TriMesh room = Room();
  for (const bool inverse : {false, true}) {
    FakeSequence sequence(room);
    sequence.SayPoses([inverse](const Pose& pose) {
      const Pose file = pose * HalfTurn();
      return inverse ? file.Inverse() : file;
    });
    const InputCheck check = CheckInput(sequence, room, {});
    EXPECT_FALSE(check.given_fits);
    EXPECT_TRUE(check.readings[check.best].opengl_axes);
    EXPECT_EQ(check.readings[check.best].inverse_pose, inverse);
    EXPECT_NE(check.verdict.find("diag(1, -1, -1, 1)"), std::string::npos);
  }
}

// 5000 units a metre read as 1000: a listed unit. 1234: an estimated one.
TEST(InputCheck, FindsTheDepthUnit) {
  const TriMesh room = Room();
  for (const double shift : {5000.0, 256.0, 1234.0}) {
    const InputCheck check =
        CheckInput(FakeSequence(room, shift / 1000), room, {});
    EXPECT_FALSE(check.given_fits);
    const Reading& best = check.readings[check.best];
    EXPECT_NEAR(best.depth_shift, shift, 0.005 * shift);
    EXPECT_EQ(best.estimated_shift, shift == 1234);
    EXPECT_FALSE(best.inverse_pose);
    EXPECT_NE(check.verdict.find("m_depthShift"), std::string::npos);
  }
}

// Two mistakes at once are both named.
TEST(InputCheck, FindsTwoMistakes) {
  const TriMesh room = Room();
  FakeSequence sequence(room, 5);
  sequence.SayPoses([](const Pose& pose) { return pose.Inverse(); });
  const InputCheck check = CheckInput(sequence, room, {});
  EXPECT_NE(check.verdict.find("world-to-camera"), std::string::npos);
  EXPECT_NE(check.verdict.find("5000"), std::string::npos);
}

// Depth is the same from both sides of a surface: only the order of the corners
// tells that no texel faces a camera.
TEST(InputCheck, FindsAMeshInsideOut) {
  TriMesh mesh = Room();
  mesh.faces.resize(10);  // the room without its block
  const Eigen::Vector3d inside(0.2, 0, 0.2);
  for (size_t f = 0; f < mesh.NumFaces(); ++f) {
    if (mesh.FaceCross(f).dot(mesh.FaceCentroid(f) - inside) < 0) {
      std::swap(mesh.faces[f][1], mesh.faces[f][2]);
    }
  }
  const FakeSequence scan(mesh);
  const InputCheck turned = CheckInput(scan, mesh, {});
  EXPECT_GT(turned.behind_share, 0.99);
  EXPECT_FALSE(turned.given_fits);
  EXPECT_NE(turned.verdict.find("inside out"), std::string::npos);
  for (auto& face : mesh.faces) std::swap(face[1], face[2]);
  const InputCheck good = CheckInput(scan, mesh, {});
  EXPECT_LT(good.behind_share, 0.01);
  EXPECT_TRUE(good.given_fits) << good.verdict;
}

// A mesh of somewhere else: nothing fits, and that is what it says.
TEST(InputCheck, ForeignMeshFitsNothing) {
  const TriMesh room = Room();
  TriMesh elsewhere = room;
  for (Eigen::Vector3d& v : elsewhere.vertices) v += Eigen::Vector3d(0, 60, 0);
  for (const TriMesh& mesh : {elsewhere, TriMesh()}) {
    const InputCheck check = CheckInput(FakeSequence(room), mesh, {});
    EXPECT_FALSE(check.given_fits);
    EXPECT_EQ(check.best, 0);
    EXPECT_EQ(check.verdict.find("No convention fits"), 0u);
  }
}

// Only usable frames are compared; without any readable one it is an error,
// without any depth unsolvable.
TEST(InputCheck, FramesThatCannotBeCompared) {
  const TriMesh room = Room();
  FakeSequence sequence(room);
  for (int i = 0; i < 9; ++i) sequence.SetUnusable(i);
  EXPECT_EQ(CheckInput(sequence, room, {}).frames, std::vector<int>{9});
  sequence.fails_ = true;
  EXPECT_THROW(CheckInput(sequence, room, {}), InputError);
  EXPECT_THROW(CheckInput(FakeSequence(room, 0), room, {}), UnsolvableError);
}

}  // namespace
}  // namespace facet
