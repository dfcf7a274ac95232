// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "texture/atlas.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "tests/texture/texture_scenes.h"
#include "texture/pack_rectangles.h"
#include "texture/texels.h"
#include "util/errors.h"
#include "util/parallel_for.h"
#include "util/random.h"

namespace facet {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// A bumpy wall, tilted in space: one cluster, all faces frontal.
PlaneScene BumpyWall(uint64_t seed) {
  PlaneScene scene;
  const Eigen::Quaterniond turn(
      Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized()));
  AddQuadGrid(Vector3d(1, -2, 3),
              turn * Vector3d(0.31, 0, 0),
              turn * Vector3d(0, 0.17, 0),
              7,
              5,
              &scene);
  Random random(seed);
  const Vector3d n = scene.partition.clusters[0].plane.normal;
  for (auto& v : scene.mesh.vertices) v += n * random.Uniform(-0.005, 0.005);
  return scene;
}

// A strip that goes right, then folds back above itself: one cluster.
PlaneScene FoldedStrip() {
  PlaneScene scene;
  auto& m = scene.mesh;
  // Profile along x and z: lower sheet, steep riser leaning back, upper sheet.
  const double xs[] = {0, 0.1, 0.05, 0.15};
  const double zs[] = {0, 0, 0.04, 0.04};
  for (int i = 0; i < 4; ++i) {
    m.vertices.emplace_back(xs[i], 0, zs[i]);
    m.vertices.emplace_back(xs[i], 0.1, zs[i]);
  }
  for (int i = 0; i < 3; ++i) {
    const int a = 2 * i;
    m.faces.push_back({a, a + 2, a + 1});
    m.faces.push_back({a + 1, a + 2, a + 3});
  }
  scene.partition.face_cluster.assign(m.faces.size(), 0);
  PlaneCluster cluster;  // +z
  cluster.centroid = Vector3d(0.07, 0.05, 0.02);
  cluster.plane.offset = -0.02;
  scene.partition.clusters.push_back(cluster);
  return scene;
}

TEST(Atlas, TexelsBelongToOneFaceAndReproject) {
  // p -> chart px must give back the centre the texel came from (up to float),
  // each centre once. Breaks with any half-pixel or gutter slip.
  const PlaneScene scene = BumpyWall(3);
  AtlasOptions options;
  const Atlas atlas = BuildAtlas(scene.mesh, scene.partition, options);
  ASSERT_EQ(atlas.charts.size(), 1u);
  const Chart& chart = atlas.charts[0];
  const TexelSet texels =
      SampleTexels(scene.mesh, scene.partition, atlas, {1, 0});
  std::set<std::pair<int, int>> centres;
  for (size_t i = 0; i < texels.size(); ++i) {
    const Vector2d px =
        chart.ToPixel(texels.position[i].cast<double>(), atlas.spacing_m) -
        Vector2d(0.5, 0.5);
    EXPECT_NEAR(px.x(), std::round(px.x()), 2e-3);
    EXPECT_NEAR(px.y(), std::round(px.y()), 2e-3);
    EXPECT_TRUE(centres
                    .emplace(static_cast<int>(std::round(px.x())),
                             static_cast<int>(std::round(px.y())))
                    .second);
    const auto& b = texels.bary[i];
    const auto& f = scene.mesh.faces[texels.face[i]];
    const Vector3d p = (1 - b[0] - b[1]) * scene.mesh.vertices[f[0]] +
                       b[0] * scene.mesh.vertices[f[1]] +
                       b[1] * scene.mesh.vertices[f[2]];
    EXPECT_LT((p - texels.position[i].cast<double>()).norm(), 1e-6);
  }
}

TEST(Atlas, TexelAreaIsProjectedArea) {
  // Sum of texels * h^2 against the rectangle's area, within 1 %.
  const PlaneScene scene = BumpyWall(4);
  for (double h : {0.001, 0.0025}) {
    AtlasOptions options;
    options.texel_size_m = h;
    const Atlas atlas = BuildAtlas(scene.mesh, scene.partition, options);
    const TexelSet texels =
        SampleTexels(scene.mesh, scene.partition, atlas, {1, 0});
    EXPECT_NEAR(static_cast<double>(texels.size()) * h * h,
                0.31 * 0.17,
                0.01 * 0.31 * 0.17);
  }
}

TEST(Atlas, StrideKeepsItsShareAndSmallCharts) {
  // Stride s keeps about 1/s^2 of the texels, and at least one even when the
  // chart is narrower than s.
  PlaneScene scene = BumpyWall(5);
  AddQuadGrid(Vector3d(0, 0, 0),
              Vector3d(0.006, 0, 0),
              Vector3d(0, 0.006, 0),
              1,
              1,
              &scene);
  const Atlas atlas = BuildAtlas(scene.mesh, scene.partition, {});
  const auto full = SampleTexels(scene.mesh, scene.partition, atlas, {1, 0});
  for (int stride : {2, 4, 16}) {
    const auto sparse =
        SampleTexels(scene.mesh, scene.partition, atlas, {stride, 0});
    EXPECT_EQ(sparse.plane.back(), 1);
    EXPECT_NEAR(1.0 * full.size() / sparse.size() / (stride * stride),
                1,
                stride == 16 ? 0.25 : 0.1);
    EXPECT_TRUE(std::is_sorted(sparse.plane.begin(), sparse.plane.end()));
  }
  EXPECT_THROW(SampleTexels(scene.mesh, scene.partition, atlas, {0, 0}),
               OptionsError);
}

TEST(Texels, KeepAwayFromSharpEdgesOnly) {
  // Two halves of a wall that are two clusters in one plane, and a wall at a
  // right angle: texels stay away from the corner and from the open rim, not
  // from the border that is none of the shape. Fails if all borders of clusters
  // count, or if the margin is taken in pixels.
  constexpr double kMargin = 0.03;
  PlaneScene scene;
  const auto quad = [&](Vector3d corner, Vector3d u) {
    AddQuadGrid(corner, u, Vector3d(0, 0.4, 0), 4, 4, &scene);
  };
  quad(Vector3d(0, 0, 2), Vector3d(0.4, 0, 0));
  quad(Vector3d(0.4, 0, 2), Vector3d(0.4, 0, 0));
  quad(Vector3d(0.8, 0, 2), Vector3d(0, 0, -0.4));
  // The quads share their vertices where they meet.
  for (auto& face : scene.mesh.faces) {
    for (int& v : face) {
      int first = 0;
      while ((scene.mesh.vertices[first] - scene.mesh.vertices[v]).norm() >
             1e-9) {
        ++first;
      }
      v = first;
    }
  }
  AtlasOptions options;
  options.texel_size_m = 0.005;
  const Atlas atlas = BuildAtlas(scene.mesh, scene.partition, options);
  const TexelSet texels =
      SampleTexels(scene.mesh, scene.partition, atlas, {1, kMargin});
  // What the margin takes from E_c stays in E_p.
  EXPECT_EQ(texels.size() + texels.margin_position.size(),
            SampleTexels(scene.mesh, scene.partition, atlas, {1, 0}).size());
  EXPECT_EQ(texels.margin_position.size(), texels.margin_plane.size());
  double nearest_border = 1;
  for (size_t i = 0; i < texels.size(); ++i) {
    const Vector3d p = texels.position[i].cast<double>();
    const double along = p.x() + (2 - p.z());  // 0 ... 1.2 over the three
    EXPECT_GT(
        std::min(
            {p.y(), 0.4 - p.y(), along, 1.2 - along, std::abs(along - 0.8)}),
        kMargin - 0.0075);
    nearest_border = std::min(nearest_border, std::abs(along - 0.4));
  }
  EXPECT_LT(nearest_border, 0.005);
}

TEST(Atlas, FrameIsRightHandedSeenFromOutside) {
  // The page must show the surface unmirrored: down x right = normal.
  const PlaneScene scene = BumpyWall(6);
  const Atlas atlas = BuildAtlas(scene.mesh, scene.partition, {});
  const Chart& chart = atlas.charts[0];
  EXPECT_NEAR(
      chart.Normal().dot(scene.partition.clusters[0].plane.normal), 1, 1e-12);
  EXPECT_GE(chart.width, chart.height);
}

TEST(Atlas, FoldedClusterGetsChartsWithoutOverlap) {
  // Lower and upper sheet overlap by 5 cm; the riser between leans back, so it
  // is turned over. No texel of the pages may have two owners.
  const PlaneScene scene = FoldedStrip();
  const Atlas atlas = BuildAtlas(scene.mesh, scene.partition, {});
  EXPECT_GE(atlas.charts.size(), 3u);
  EXPECT_EQ(atlas.num_back_faces, 2u);
  ASSERT_EQ(atlas.page_size.size(), 1u);
  const auto [width, height] = atlas.page_size[0];
  std::vector<int> owners(static_cast<size_t>(width) * height, -1);
  for (size_t f = 0; f < scene.mesh.NumFaces(); ++f) {
    UvTriangle uv;
    for (int k = 0; k < 3; ++k) uv[k] = atlas.face_uv[f][k].cast<double>();
    int mine = 0;
    RasterizeTriangle(uv, width, height, [&](int col, int row) {
      int& owner = owners[static_cast<size_t>(row) * width + col];
      EXPECT_EQ(owner, -1);
      owner = static_cast<int>(f);
      ++mine;
    });
    EXPECT_GT(mine, 0);
  }
  // Back and steep charts take no part in the optimisation.
  const auto texels = SampleTexels(scene.mesh, scene.partition, atlas, {1, 0});
  for (int face : texels.face) {
    EXPECT_FALSE(face == 2 || face == 3);
  }
}

TEST(Atlas, OverlappingFrontFacesStartAnotherChart) {
  // A helix-like ramp of one turn and a quarter: all faces frontal, connected,
  // and the last quarter lies above the first.
  PlaneScene scene;
  const int steps = 40;
  for (int i = 0; i <= steps; ++i) {
    const double angle = 2.5 * M_PI * i / steps, z = 0.03 * i / steps;
    for (double r : {0.05, 0.1}) {
      scene.mesh.vertices.emplace_back(
          r * std::cos(angle), r * std::sin(angle), z);
    }
  }
  for (int i = 0; i < steps; ++i) {
    const int a = 2 * i;
    scene.mesh.faces.push_back({a, a + 1, a + 2});
    scene.mesh.faces.push_back({a + 1, a + 3, a + 2});
  }
  scene.partition.face_cluster.assign(scene.mesh.faces.size(), 0);
  scene.partition.clusters.resize(1);
  const Atlas atlas = BuildAtlas(scene.mesh, scene.partition, {});
  EXPECT_GE(atlas.charts.size(), 2u);
  EXPECT_GE(atlas.num_folded_charts, 1u);
  EXPECT_EQ(atlas.num_steep_faces, 0u);
  size_t owned = 0;
  for (size_t c = 0; c < atlas.charts.size(); ++c) {
    for (int face : ChartOwners(atlas, static_cast<int>(c))) owned += face >= 0;
  }
  double area = 0;
  for (size_t f = 0; f < scene.mesh.NumFaces(); ++f) {
    area += 0.5 * std::abs(scene.mesh.FaceCross(f).z());
  }
  // Nothing was hidden by the overlap: all projected area has its texels.
  EXPECT_NEAR(owned * 0.0025 * 0.0025, area, 0.03 * area);
}

TEST(Atlas, SteepFacesGetTheirOwnProjection) {
  // A wall of 90 degrees in the cluster of the floor: projected along the
  // floor's normal it would have no texels.
  PlaneScene scene;
  AddQuadGrid(Vector3d(0, 0, 0),
              Vector3d(0.2, 0, 0),
              Vector3d(0, -0.2, 0),
              2,
              2,
              &scene);
  AddQuadGrid(Vector3d(0, 0, 0),
              Vector3d(0.2, 0, 0),
              Vector3d(0, 0, -0.1),
              2,
              1,
              &scene);
  scene.partition.clusters.resize(1);
  scene.partition.face_cluster.assign(scene.mesh.NumFaces(), 0);
  const Atlas atlas = BuildAtlas(scene.mesh, scene.partition, {});
  EXPECT_EQ(atlas.num_steep_faces, 4u);
  EXPECT_NEAR(atlas.steep_area_m2, 0.02, 1e-9);
  for (size_t c = 0; c < atlas.charts.size(); ++c) {
    if (!atlas.charts[c].steep) continue;
    size_t owned = 0;
    for (int face : ChartOwners(atlas, static_cast<int>(c))) owned += face >= 0;
    EXPECT_NEAR(owned * 0.0025 * 0.0025, 0.02, 0.0005);
  }
}

TEST(Atlas, ChartsStayInsidePagesWithTheirGutter) {
  // Many walls: boxes must not overlap, corners of faces must keep the gutter.
  PlaneScene scene;
  Random random(7);
  for (int i = 0; i < 60; ++i) {
    AddQuadGrid(Vector3d(i, 0, 0),
                Vector3d(random.Uniform(0.02, 0.5), 0, 0),
                Vector3d(0, random.Uniform(0.02, 0.5), 0),
                1,
                1,
                &scene);
  }
  AtlasOptions options;
  options.page_size = 256;
  const Atlas atlas = BuildAtlas(scene.mesh, scene.partition, options);
  EXPECT_GT(atlas.page_size.size(), 1u);
  for (size_t i = 0; i < atlas.charts.size(); ++i) {
    const Chart& a = atlas.charts[i];
    EXPECT_LE(a.x + a.width, atlas.page_size[a.page][0]);
    EXPECT_LE(a.y + a.height, atlas.page_size[a.page][1]);
    EXPECT_EQ(atlas.page_size[a.page][1] % 4, 0);
    for (size_t j = 0; j < i; ++j) {
      const Chart& b = atlas.charts[j];
      EXPECT_TRUE(a.page != b.page || a.x + a.width <= b.x ||
                  b.x + b.width <= a.x || a.y + a.height <= b.y ||
                  b.y + b.height <= a.y);
    }
    for (int face : a.faces) {
      for (const Vector2d& p : atlas.ChartUv(face)) {
        EXPECT_GE(p.minCoeff(), 8 - 1e-3);
        EXPECT_LE(p.x(), a.width - 8 + 1e-3);
        EXPECT_LE(p.y(), a.height - 8 + 1e-3);
      }
    }
  }
}

TEST(Atlas, OversizeChartsAreSplit) {
  // A wall of 400 x 80 texels on pages of 128: pieces, none larger, every face
  // in one of them. One face too large for a page enlarges the page instead.
  PlaneScene scene;
  AddQuadGrid(
      Vector3d(0, 0, 0), Vector3d(1, 0, 0), Vector3d(0, 0.2, 0), 20, 4, &scene);
  AtlasOptions options;
  options.page_size = 128;
  Atlas atlas = BuildAtlas(scene.mesh, scene.partition, options);
  size_t faces = 0;
  for (const Chart& chart : atlas.charts) {
    EXPECT_LE(std::max(chart.width, chart.height), 128);
    faces += chart.faces.size();
  }
  EXPECT_EQ(faces, scene.mesh.NumFaces());
  PlaneScene big;
  AddQuadGrid(
      Vector3d(0, 0, 0), Vector3d(1, 0, 0), Vector3d(0, 1, 0), 1, 1, &big);
  atlas = BuildAtlas(big.mesh, big.partition, options);
  EXPECT_GE(atlas.page_size[0][0], 400);
}

TEST(Atlas, DegenerateFacesAreHarmless) {
  // Zero-area faces keep finite coordinates and own nothing.
  PlaneScene scene = BumpyWall(8);
  scene.mesh.faces.push_back({0, 0, 1});
  scene.mesh.faces.push_back({2, 2, 2});
  scene.partition.face_cluster.resize(scene.mesh.NumFaces(), 0);
  const Atlas atlas = BuildAtlas(scene.mesh, scene.partition, {});
  for (const auto& uv : atlas.face_uv) {
    for (const auto& p : uv) EXPECT_TRUE(p.allFinite());
  }
  PlaneScene empty;
  EXPECT_TRUE(BuildAtlas(empty.mesh, empty.partition, {}).charts.empty());
}

TEST(Atlas, SameAtAnyThreadCount) {
  PlaneScene scene;
  for (int i = 0; i < 20; ++i) {
    AddQuadGrid(Vector3d(i, 0, 0),
                Vector3d(0.1 + 0.01 * (i % 5), 0, 0),
                Vector3d(0, 0.1, 0.01 * i),
                3,
                2,
                &scene);
  }
  SetNumThreads(1);
  const Atlas one = BuildAtlas(scene.mesh, scene.partition, {});
  SetNumThreads(4);
  const Atlas four = BuildAtlas(scene.mesh, scene.partition, {});
  SetNumThreads(0);
  ASSERT_EQ(one.face_uv.size(), four.face_uv.size());
  EXPECT_TRUE(one.face_uv == four.face_uv);
  EXPECT_TRUE(one.face_page == four.face_page);
}

TEST(Atlas, RefusesOptionsOutOfRange) {
  const PlaneScene scene = BumpyWall(9);
  AtlasOptions options;
  options.texel_size_m = 0;
  EXPECT_THROW(BuildAtlas(scene.mesh, scene.partition, options), OptionsError);
  options = {};
  options.page_size = 20;
  EXPECT_THROW(BuildAtlas(scene.mesh, scene.partition, options), OptionsError);
  options = {};
  options.texel_size_m = 1e-6;  // a wall of 310,000 texels
  EXPECT_THROW(BuildAtlas(scene.mesh, scene.partition, options),
               UnsolvableError);
}

}  // namespace
}  // namespace facet
