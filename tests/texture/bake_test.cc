// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "texture/bake.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "tests/texture/bake_wall.h"
#include "texture/textured_mesh.h"
#include "util/errors.h"
#include "util/parallel_for.h"
#include "util/random.h"

namespace facet {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

TEST(Bake, ReproducesTheWallAndItsGutter) {
  // Linear paint passes bilinear lookups unchanged; what is left is rounding to
  // 8 bits in image and page. Shifts of half a texel or pixel are 2 and more.
  for (BakeSampler sampler : {BakeSampler::kBilinear, BakeSampler::kBicubic}) {
    Wall wall;
    wall.options.sampler = sampler;
    const auto pages = wall.Bake();
    ASSERT_EQ(pages.size(), 1u);
    EXPECT_LT(wall.LargestError(pages[0], 0), 1.3);
    EXPECT_LT(wall.LargestError(pages[0], wall.options.ring_px), 1.3);
    EXPECT_EQ(wall.report.seen, wall.report.texels);
    EXPECT_EQ(wall.report.texels, 60u * 48u);
    EXPECT_NEAR(wall.report.mean_views, 3, 1e-9);
    EXPECT_EQ(cv::countNonZero(wall.report.unseen_mask[0]), 0);
  }
}

TEST(Bake, LookupsOnFacesHaveNoHalfPixelShift) {
  // The round trip face point -> uv -> page -> colour against the paint there.
  Wall wall;
  const TexturedMesh model = wall.Model(wall.Bake());
  Random random(1);
  for (int i = 0; i < 300; ++i) {
    const int face = static_cast<int>(random.Index(model.mesh.NumFaces()));
    float u = static_cast<float>(random.Uniform());
    float v = static_cast<float>(random.Uniform());
    if (u + v > 1) {
      u = 1 - u;
      v = 1 - v;
    }
    const auto& f = model.mesh.faces[face];
    const Vector3d p = (1.0 - u - v) * model.mesh.vertices[f[0]] +
                       u * model.mesh.vertices[f[1]] +
                       v * model.mesh.vertices[f[2]];
    EXPECT_LT((ColorAt(model, face, u, v).cast<double>() - Paint(p))
                  .cwiseAbs()
                  .maxCoeff(),
              1.3);
  }
}

TEST(Bake, OuterGutterCopiesTheEdge) {
  // Beyond the ring the gutter is constant outwards; no background shows.
  Wall wall;
  wall.options.ring_px = 0;
  const cv::Mat page = wall.Bake()[0];
  const Chart& chart = wall.atlas.charts[0];
  const int y = chart.y + chart.height / 2;
  for (int x = 1; x <= 8; ++x) {
    EXPECT_EQ(page.at<cv::Vec3b>(y, chart.x + 8 - x),
              page.at<cv::Vec3b>(y, chart.x + 8));
  }
}

TEST(Bake, RobustPassRemovesHighlights) {
  // One frame of seven carries a white blot. Without the robust pass the mean
  // is off by more than 10 grey values there. (A trimmed mean fails here: the
  // highlight pulls it so far that good samples go as well.)
  Wall wall(7);
  cv::Mat& image = wall.sequence.color(3);
  image.setTo(cv::Scalar(255, 255, 255));
  wall.options.robust_luma = 0;
  wall.options.sharpness_power = 0;
  EXPECT_GT(wall.LargestError(wall.Bake()[0], 0), 10);
  EXPECT_EQ(wall.report.dropped, 0u);
  wall.options.robust_luma = 0.1;
  EXPECT_LT(wall.LargestError(wall.Bake()[0], 0), 1.3);
  EXPECT_GT(wall.report.dropped, 2000u);
}

TEST(Bake, BestViewPowerPrefersTheNearView) {
  // Two frames that disagree, one at half the distance: with a large power the
  // near one decides, with all powers 0 the mean does.
  Wall wall(0);
  wall.Add(Pose());
  wall.Add(Pose(Eigen::Quaterniond::Identity(), Vector3d(0, 0, 0.5)));
  wall.sequence.color(0).setTo(cv::Scalar(80, 80, 80));
  wall.sequence.color(1).setTo(cv::Scalar(120, 120, 120));
  wall.options.robust_luma = 0;
  wall.options.sharpness_power = 0;
  wall.options.depth_power = 2;
  wall.options.best_view_power = 16;
  const Chart& chart = wall.atlas.charts[0];
  const int x = chart.x + chart.width / 2, y = chart.y + chart.height / 2;
  EXPECT_EQ(wall.Bake()[0].at<cv::Vec3b>(y, x)[0], 80);
  wall.options.angle_power = wall.options.depth_power = 0;
  wall.options.best_view_power = 1;
  EXPECT_EQ(wall.Bake()[0].at<cv::Vec3b>(y, x)[0], 100);
}

// Breaks when the powers are left out or inverted, or when texels have those of
// another square than their own.
TEST(Bake, ViewsCountByThePixelsTheyHaveForAMetre) {
  const auto two_views = [](const Pose& second) {
    auto wall = std::make_unique<Wall>(0);
    wall->Add(Pose());
    wall->Add(second);
    wall->sequence.color(0).setTo(cv::Scalar::all(80));
    wall->sequence.color(1).setTo(cv::Scalar::all(120));
    return wall;
  };
  const auto twice_as_far =
      two_views(Pose(Eigen::Quaterniond::Identity(), Vector3d(0, 0, 0.5)));
  const Chart& chart = twice_as_far->atlas.charts[0];
  const int y = chart.y + chart.height / 2;
  EXPECT_NEAR(
      twice_as_far->Bake()[0].at<cv::Vec3b>(y, chart.x + chart.width / 2)[0],
      (2 * 80 + 120) / 3.0,
      1);

  // About the wall's centre: nearer on one side.
  const Eigen::Quaterniond turn(
      Eigen::AngleAxisd(50 * M_PI / 180, Vector3d::UnitY()));
  const Vector3d center(0, 0, 0.5);
  const auto turned = two_views(Pose(turn, center - turn * center));
  const cv::Mat by_square = turned->Bake()[0];
  EXPECT_GT(std::abs(by_square.at<cv::Vec3b>(y, chart.x + 9)[0] -
                     by_square.at<cv::Vec3b>(y, chart.x + chart.width - 9)[0]),
            3);
  turned->options.visibility_px = 1;
  EXPECT_LE(cv::norm(by_square, turned->Bake()[0], cv::NORM_INF), 1);
}

TEST(Bake, WarpMovesTheLookup) {
  // A constant warp of (2, 0) px reads the paint 2 px further right: 4 mm at
  // f = 250 and z = 0.5, that is 5.6 grey values of red.
  Wall wall(1);
  std::vector<double> warp(2ul * wall.lattice.NumVertices(), 0);
  for (size_t i = 0; i < warp.size(); i += 2) warp[i] = 2;
  const cv::Mat plain = wall.Bake()[0], moved = wall.Bake(warp)[0];
  const Chart& chart = wall.atlas.charts[0];
  const int x = chart.x + chart.width / 2, y = chart.y + chart.height / 2;
  EXPECT_NEAR(
      moved.at<cv::Vec3b>(y, x)[0] - plain.at<cv::Vec3b>(y, x)[0], 5.6, 1.1);
  EXPECT_NEAR(
      moved.at<cv::Vec3b>(y, x)[1] - plain.at<cv::Vec3b>(y, x)[1], 0, 1.1);
}

TEST(Bake, WallWithoutAnyFrameTakesVertexColours) {
  Wall wall(0);
  wall.scene.mesh.vertex_colors.assign(wall.scene.mesh.NumVertices(),
                                       Rgb{10, 20, 30});
  const cv::Mat page = wall.Bake()[0];
  const Chart& chart = wall.atlas.charts[0];
  EXPECT_EQ(page.at<cv::Vec3b>(chart.y + 20, chart.x + 20),
            cv::Vec3b(10, 20, 30));
  EXPECT_EQ(wall.report.seen, 0u);
}

TEST(Bake, SteepFacesAreColouredWhereTheyAre) {
  // A step of 4 cm depth whose riser belongs to the wall's cluster: its texels
  // must show the riser's paint, which depends on z only.
  PlaneScene scene;
  AddQuadGrid(Vector3d(-0.1, -0.1, 0.5),
              Vector3d(0.2, 0, 0),
              Vector3d(0, 0.2, 0),
              2,
              2,
              &scene);
  AddQuadGrid(Vector3d(-0.1, 0.1, 0.5),
              Vector3d(0.2, 0, 0),
              Vector3d(0, 0, -0.1),
              2,
              2,
              &scene);
  scene.partition.clusters.resize(1);
  scene.partition.face_cluster.assign(scene.mesh.NumFaces(), 0);
  const Atlas atlas = BuildAtlas(scene.mesh, scene.partition, {});
  MemorySequence sequence(TestCalibration());
  const auto paint = [](const Vector3d& x) {
    const auto grey = static_cast<uint8_t>(std::lround(400 * x.z()));
    return cv::Vec3b(grey, grey, grey);
  };
  // From above, looking down at the floor-like riser.
  const Pose pose(Eigen::Quaterniond(Eigen::AngleAxisd(0.5, Vector3d::UnitX())),
                  Vector3d(0, 0.15, 0.2));
  for (int i = 0; i < 2; ++i) sequence.AddRendered(scene.mesh, pose, paint);
  BakeReport report;
  VisibilityOptions visibility;
  visibility.test_depth_edges = visibility.test_mesh_edges = false;
  const std::vector<Plane> planes = scene.Planes();
  const std::vector<int> frames = sequence.AllFrames();
  const KeyframeImages images = LoadKeyframeColors(sequence, frames);
  const std::vector<Pose> poses = sequence.AllPoses();
  const std::vector<double> warps;
  const TextureState state = {scene.mesh, planes, images, poses, warps};
  const RayScene rays(scene.mesh);
  const WarpLattice lattice = {20, 16, 320, 240};
  const TextureBaker baker(
      state, atlas, rays, sequence, frames, lattice, visibility, {});
  const auto pages = baker.Bake(&report);
  size_t checked = 0;
  for (size_t c = 0; c < atlas.charts.size(); ++c) {
    const Chart& chart = atlas.charts[c];
    if (!chart.steep) continue;
    const auto owners = ChartOwners(atlas, static_cast<int>(c));
    for (int y = 10; y < chart.height - 10; ++y) {
      for (int x = 10; x < chart.width - 10; ++x) {
        if (owners[static_cast<size_t>(y) * chart.width + x] < 0) continue;
        if (report.unseen_mask[0].at<uint8_t>(chart.y + y, chart.x + x)) {
          continue;
        }
        const Vector3d p =
            chart.origin +
            atlas.spacing_m * ((x + 0.5) * chart.e1 + (y + 0.5) * chart.e2);
        EXPECT_NEAR(pages[0].at<cv::Vec3b>(chart.y + y, chart.x + x)[0],
                    400 * p.z(),
                    2.5);
        ++checked;
      }
    }
  }
  EXPECT_GT(checked, 500u);
}

TEST(Bake, ExposuresAreTakenOutAndPutBack) {
  // Two cameras see the paint each under an exposure of its own. At the common
  // exposure the page is the paint, with all of the local one the mean of what
  // they saw. Breaks if an exposure is applied twice, or its inverse.
  Wall wall(0);
  Exposure dark, light;  // undo what the cameras do
  dark.gain.setConstant(1.1f);
  dark.offset.setConstant(-0.05f);
  light.gain.setConstant(0.95f);
  light.offset.setConstant(0.02f);
  wall.exposures = {dark, light};
  const auto seen = [](const Exposure& undo, const Vector3d& paint) {
    return Vector3d((paint.array() - 255.0 * undo.offset.cast<double>()) /
                    undo.gain.cast<double>());
  };
  for (const Exposure& undo : wall.exposures) {
    wall.sequence.AddRendered(
        wall.WideWall(), Pose(), [&](const Vector3d& x) -> cv::Vec3b {
          const Vector3d c = seen(undo, Paint(x));
          return {cv::saturate_cast<uint8_t>(c[0]),
                  cv::saturate_cast<uint8_t>(c[1]),
                  cv::saturate_cast<uint8_t>(c[2])};
        });
  }
  wall.options.local_exposure = 0;
  EXPECT_LT(wall.LargestError(wall.Bake()[0], 0), 2);
  const cv::Mat common = wall.Bake()[0];
  wall.options.local_exposure = 1;
  const cv::Mat local = wall.Bake()[0];
  const Chart& chart = wall.atlas.charts[0];
  for (int i = 10; i < std::min(chart.width, chart.height) - 10; ++i) {
    for (int k = 0; k < 3; ++k) {
      const Vector3d paint =
          Vector3d::Constant(common.at<cv::Vec3b>(chart.y + i, chart.x + i)[k]);
      EXPECT_NEAR(local.at<cv::Vec3b>(chart.y + i, chart.x + i)[k],
                  0.5 * (seen(dark, paint) + seen(light, paint))[0],
                  1.6);
    }
  }
}

TEST(Bake, SameAtAnyThreadCount) {
  Wall wall(5);
  SetNumThreads(1);
  const cv::Mat one = wall.Bake()[0];
  SetNumThreads(4);
  const cv::Mat four = wall.Bake()[0];
  SetNumThreads(0);
  EXPECT_EQ(cv::norm(one, four, cv::NORM_INF), 0);
}

// Breaks if a wanted face lacks a texel, or nothing is saved.
TEST(Bake, RefusesBadPowers) {
  Wall wall(1);
  wall.options.best_view_power = 0;
  EXPECT_THROW(wall.Bake(), OptionsError);
}

TEST(KeyframeImages, LumaAndSmoothMatchTheImage) {
  // A grey ramp keeps its values under luma and, inside, under the Gaussian.
  Wall wall(2);
  KeyframeImages images = LoadKeyframeColors(wall.sequence, {1, 0});
  SetExposures({}, 0.8, &images);
  ASSERT_EQ(images.size(), 2u);
  const auto& c = wall.sequence.color(1).at<cv::Vec3b>(100, 100);
  const cv::Mat luma = LumaOf(images, 0);
  EXPECT_NEAR(luma.at<float>(100, 100),
              (0.299 * c[0] + 0.587 * c[1] + 0.114 * c[2]) / 255,
              1e-5);
  EXPECT_NEAR(
      images.smooth[0].at<float>(120, 160), luma.at<float>(120, 160), 0.01);
}

}  // namespace
}  // namespace facet
