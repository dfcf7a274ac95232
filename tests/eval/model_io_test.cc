// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "texture/model_io.h"

#include <gtest/gtest.h>

#include <opencv2/imgcodecs.hpp>

#include "tests/support/temp_dir.h"
#include "util/atomic_file.h"
#include "util/errors.h"

namespace facet {
namespace {

class LoadModelTest : public ::testing::Test {
 protected:
  // 4 x 2 page: upper left texel red, lower right one blue, others green.
  LoadModelTest() {
    cv::Mat bgr(2, 4, CV_8UC3, cv::Scalar(0, 255, 0));
    bgr.at<cv::Vec3b>(0, 0) = {0, 0, 255};
    bgr.at<cv::Vec3b>(1, 3) = {255, 0, 0};
    cv::imwrite(dir_ / "page.png", bgr);
    WriteFileAtomically(dir_ / "mesh.mtl",
                        "newmtl a\nKd 1 1 1\nmap_Kd page.png\n"
                        "newmtl b\nKd 1 0.5 0\n");
  }
  TexturedMesh Load(const std::string& obj) const {
    WriteFileAtomically(dir_ / "mesh.obj", obj);
    return LoadModel(dir_.path());
  }
  const std::string square_ =
      "mtllib mesh.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
      "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";
  TempDir dir_;
};

// The vt axis points up, page rows down: a flipped axis, a shift by half a
// texel or BGR order would return another colour.
TEST_F(LoadModelTest, TextureIsUpright) {
  const TexturedMesh m = Load(square_ + "usemtl a\nf 1/1 2/2 3/3 4/4\n");
  ASSERT_EQ(m.mesh.NumFaces(), 2u);
  ASSERT_TRUE(HasColor(m));
  // Faces (v1, v2, v3) and (v1, v3, v4); v4 is the upper left corner.
  EXPECT_EQ(ColorAt(m, 1, 0, 1), Eigen::Vector3f(255, 0, 0));
  EXPECT_EQ(ColorAt(m, 0, 1, 0), Eigen::Vector3f(0, 0, 255));
  EXPECT_EQ(ColorAt(m, 0, 0, 0), Eigen::Vector3f(0, 255, 0));
  // Between the centres of texels (0, 0) and (1, 0): x = 1 of 4 and y = 0.5 of
  // 2, that is vt (0.25, 0.75) = 0.25 v3 + 0.5 v4 + 0.25 v1.
  const Eigen::Vector3f between = ColorAt(m, 1, 0.25f, 0.5f);
  EXPECT_LT((between - Eigen::Vector3f(127.5, 127.5, 0)).norm(), 1e-3);
}

// Any index form, materials without an image, plane groups, tiled coordinates.
TEST_F(LoadModelTest, ReadsWhatOthersWrite) {
  const TexturedMesh m = Load(square_ +
                              "vn 0 0 1\nvt 2 1\nvt 3 2\nvt 2 2\n"
                              "g plane_7\nusemtl a\nf -4/-7/1 -3/-6/1 -2/-5/1\n"
                              "g plane_8\nusemtl b\nf 1//1 3//1 4//1\n"
                              "usemtl a\r\nf 1/5 \\\n3/6 4/7\r\n# end\n");
  ASSERT_EQ(m.mesh.NumFaces(), 3u);
  EXPECT_EQ(m.face_plane, (std::vector<int>{7, 8, 8}));
  EXPECT_EQ(m.mesh.faces[0], (std::array<int, 3>{0, 1, 2}));
  EXPECT_EQ(ColorAt(m, 0, 1, 0), Eigen::Vector3f(0, 0, 255));
  EXPECT_EQ(ColorAt(m, 1, 0.2f, 0.2f), Eigen::Vector3f(255, 128, 0));
  EXPECT_EQ(ColorAt(m, 2, 0, 1), Eigen::Vector3f(255, 0, 0));
}

TEST_F(LoadModelTest, VertexColours) {
  const TexturedMesh m =
      Load("v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 1 1 0 0 0 1\nf 1 2 3\n");
  EXPECT_TRUE(HasColor(m));
  EXPECT_EQ(ColorAt(m, 0, 1, 0), Eigen::Vector3f(0, 255, 0));
  EXPECT_LT(
      (ColorAt(m, 0, 1 / 3.f, 1 / 3.f) - Eigen::Vector3f(85, 85, 85)).norm(),
      1e-3);
  EXPECT_FALSE(HasColor(Load("v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n")));
}

// Every bad input ends in one sentence that names the file.
TEST_F(LoadModelTest, RefusesBadFiles) {
  for (const std::string bad : {"",
                                "v 0 0 0\n",
                                "v 0 0\nf 1 1 1\n",
                                "v 0 0 x\n",
                                "v 0 0 nan\n",
                                "v 0 0 0\nf 1 1\n",
                                "v 0 0 0\nf 1 1 2\n",
                                "v 0 0 0\nf 1 1 0\n",
                                "v 0 0 0\nf 1/1 1/1 1/1\n",
                                "v 0 0 0\nf -2 1 1\n",
                                "mtllib none.mtl\n"}) {
    EXPECT_THROW(Load(bad), InputError) << bad;
  }
  WriteFileAtomically(dir_ / "page.png", "no picture");
  EXPECT_THROW(Load(square_ + "usemtl a\nf 1/1 2/2 3/3\n"), InputError);
  const TempDir empty;
  EXPECT_THROW(LoadModel(empty.path()), InputError);
  EXPECT_THROW(LoadModel(empty / "none.obj"), InputError);
  EXPECT_THROW(LoadModel(empty / "none.ply"), InputError);
}

}  // namespace
}  // namespace facet
