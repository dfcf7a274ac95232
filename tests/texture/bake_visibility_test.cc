// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Which texels TextureBaker colours, and from which keyframes.
#include <gtest/gtest.h>

#include "tests/texture/bake_wall.h"
#include "texture/rasterize.h"
#include "util/random.h"

namespace facet {
namespace {

using Eigen::Vector3d;

TEST(Bake, TexelsOfASquareShareTheVerdictOfTheFirst) {
  // Noise in the sensor depth decides texel by texel. With squares of 4 every
  // texel is seen if its square's first one is in the exact bake. Breaks if
  // squares cross tiles or start at another corner.
  Wall wall(1);
  Random random(5);
  cv::Mat depth = wall.sequence.depth(0);
  for (int y = 0; y < depth.rows; ++y) {
    for (int x = 0; x < depth.cols; ++x) {
      if (random.Uniform(0, 1) < 0.4) depth.at<float>(y, x) = 0;
    }
  }
  wall.options.mild_fallback = false;
  wall.options.visibility_px = 1;
  wall.Bake();
  const cv::Mat exact = wall.report.unseen_mask[0].clone();
  wall.options.visibility_px = 4;
  wall.Bake();
  const cv::Mat shared = wall.report.unseen_mask[0];
  const Chart& chart = wall.atlas.charts[0];
  const std::vector<int> owners = ChartOwners(wall.atlas, 0);
  const auto owned = [&](int x, int y) {
    return owners[y * chart.width + x] >= 0;
  };
  int differ = 0;
  for (int y = 0; y < chart.height; ++y) {
    for (int x = 0; x < chart.width; ++x) {
      const int x0 = x / 4 * 4, y0 = y / 4 * 4;
      if (!owned(x, y) || !owned(x0, y0)) continue;
      const cv::Point at(chart.x + x, chart.y + y);
      EXPECT_EQ(shared.at<uint8_t>(at),
                exact.at<uint8_t>(chart.y + y0, chart.x + x0));
      differ += shared.at<uint8_t>(at) != exact.at<uint8_t>(at);
    }
  }
  EXPECT_GT(differ, 100);
}

TEST(Bake, AnotherStateUsesTheSameKeyframes) {
  // The state as it was, coloured over the keyframes of the moved one: the same
  // page as its own bake where both see everything, and the first camera's
  // lookups, not the second's. Breaks if poses or planes of the two are mixed.
  Wall wall;
  const std::vector<int> frames = wall.sequence.AllFrames();
  const KeyframeImages images = LoadKeyframeColors(wall.sequence, frames);
  const std::vector<Plane> planes = wall.scene.Planes();
  const std::vector<Pose> poses = wall.sequence.AllPoses();
  const std::vector<double> warps;
  std::vector<Pose> moved = poses;
  for (Pose& pose : moved) pose.translation.x() += 0.004;
  const TextureState state = {wall.scene.mesh, planes, images, poses, warps};
  const TextureState other = {wall.scene.mesh, planes, images, moved, warps};
  const RayScene rays(wall.scene.mesh);
  const TextureBaker baker(state,
                           wall.atlas,
                           rays,
                           wall.sequence,
                           frames,
                           wall.lattice,
                           wall.visibility,
                           wall.options);
  const TextureBaker moved_baker(other,
                                 wall.atlas,
                                 rays,
                                 wall.sequence,
                                 frames,
                                 wall.lattice,
                                 wall.visibility,
                                 wall.options);
  const cv::Mat page = baker.Bake()[0];
  EXPECT_EQ(cv::norm(page, moved_baker.BakeAs(state)[0], cv::NORM_INF), 0);
  EXPECT_EQ(
      cv::norm(moved_baker.Bake()[0], baker.BakeAs(other)[0], cv::NORM_INF), 0);
  EXPECT_GT(cv::norm(page, baker.BakeAs(other)[0], cv::NORM_INF), 3);
}

TEST(Bake, UnseenTexelsAreFilledAndMarked) {
  // The sensor saw nothing in a band of the wall: marked in the mask, filled
  // smoothly; linear paint is met by interpolation up to a few texels' worth.
  Wall wall;
  for (int i = 0; i < 3; ++i) {
    const Pose pose = wall.sequence.frames()[i].depth_cam_from_world;
    for (double x = -0.01; x <= 0.01; x += 0.001) {
      for (double y = -0.07; y <= 0.07; y += 0.001) {
        const auto u = wall.sequence.calibration().depth.Project(
            Vector3d(pose * Vector3d(x, y, 0.5)));
        wall.sequence.depth(i).at<float>(cvRound(u.y()), cvRound(u.x())) = 0;
      }
    }
  }
  wall.options.mild_fallback = false;
  const auto pages = wall.Bake();
  EXPECT_LT(wall.report.seen, wall.report.texels);
  EXPECT_EQ(static_cast<size_t>(cv::countNonZero(wall.report.unseen_mask[0])),
            wall.report.texels - wall.report.seen);
  EXPECT_LT(wall.LargestError(pages[0], 0), 25);
  // The mild tests do not mind missing depth: all texels get their own colour.
  const size_t strict = wall.report.seen;
  wall.options.mild_fallback = true;
  EXPECT_LT(wall.LargestError(wall.Bake()[0], 0), 1.3);
  EXPECT_EQ(wall.report.seen, wall.report.texels);
  EXPECT_EQ(wall.report.mild, wall.report.texels - strict);
}

TEST(Bake, OnlyFacesGetTheColoursOfAWholeBake) {
  Wall wall;
  const cv::Mat whole = wall.Bake()[0];
  const size_t seen = wall.report.seen;
  wall.only_faces.assign(wall.scene.mesh.NumFaces(), 1);
  EXPECT_EQ(cv::norm(whole, wall.Bake()[0], cv::NORM_INF), 0);
  for (const size_t face : {size_t{0}, wall.only_faces.size() - 1}) {
    wall.only_faces.assign(wall.only_faces.size(), 0);
    wall.only_faces[face] = 1;
    const cv::Mat part = wall.Bake()[0];
    EXPECT_LT(wall.report.seen, seen);
    const Chart& chart = wall.atlas.charts[wall.atlas.face_chart[face]];
    int texels = 0;
    RasterizeTriangle(wall.atlas.ChartUv(static_cast<int>(face)),
                      chart.width,
                      chart.height,
                      [&](int column, int row) {
                        const cv::Point at(chart.x + column, chart.y + row);
                        EXPECT_EQ(part.at<cv::Vec3b>(at),
                                  whole.at<cv::Vec3b>(at));
                        ++texels;
                      });
    EXPECT_GT(texels, 100);
  }
}

}  // namespace
}  // namespace facet
