// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "render/picture.h"

#include <gtest/gtest.h>

#include "render/preview_views.h"

namespace facet {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

void AddQuad(const Vector3d& origin,
             const Vector3d& a,
             const Vector3d& b,
             TriMesh* mesh) {
  const int i = static_cast<int>(mesh->NumVertices());
  for (const Vector3d& x : {origin,
                            Vector3d(origin + a),
                            Vector3d(origin + a + b),
                            Vector3d(origin + b)}) {
    mesh->vertices.push_back(x);
  }
  mesh->faces.push_back({i, i + 1, i + 2});
  mesh->faces.push_back({i, i + 2, i + 3});
}

// A closed room seen from inside (normals inwards), z up, with a table top.
TriMesh Room() {
  TriMesh mesh;
  const Vector3d x(4, 0, 0), y(0, 3, 0), z(0, 0, 2.5), o(0, 0, 0);
  AddQuad(o, x, y, &mesh);
  AddQuad(z, y, x, &mesh);
  AddQuad(o, y, z, &mesh);
  AddQuad(x, z, y, &mesh);
  AddQuad(o, z, x, &mesh);
  AddQuad(y, x, z, &mesh);
  AddQuad({1, 1, 0.8}, 0.3 * x, 0.3 * y, &mesh);
  return mesh;
}

PreviewView StraightDown(bool cull) {
  PreviewView view;
  view.camera = {40, 40, 31.5, 23.5, 64, 48};
  view.cull_back_faces = cull;
  // 6 m above the floor, looking along -z: x stays, y and z change sign.
  view.cam_from_world =
      Pose(Eigen::Quaterniond(0, 1, 0, 0), Vector3d(-2, 1.5, 6));
  return view;
}

Rgb Pixel(const Picture& picture, int x, int y) {
  const uint8_t* p = &picture.rgb[3 * (y * picture.width + x)];
  return {p[0], p[1], p[2]};
}

// Breaks when culling looks at the wrong side or stops at the first back face:
// through the ceiling one sees the table and the floor, without culling the
// ceiling's upper side.
TEST(Picture, CullingOpensTheRoom) {
  const TriMesh mesh = Room();
  const RayScene scene(mesh);
  const int center = 24 * 2 * 128 + 32 * 2;
  EXPECT_GE(SampleView(scene, mesh, StraightDown(true)).face[center], 12);
  const int ceiling = SampleView(scene, mesh, StraightDown(false)).face[center];
  EXPECT_TRUE(ceiling == 2 || ceiling == 3);
}

// Breaks when unshaded colours are changed on their way (textures must keep
// their values) or the background is not where nothing is hit.
TEST(Picture, UnshadedColoursAreExact) {
  const TriMesh mesh = Room();
  const SampledView sampled =
      SampleView(RayScene(mesh), mesh, StraightDown(true));
  DrawOptions options;
  options.shade = false;
  options.background_top = options.background_bottom = Vector3f(0, 0, 1);
  const Picture picture = DrawView(
      sampled, mesh, UniformColor(Vector3f(51, 102, 204) / 255.0f), options);
  ASSERT_EQ(picture.rgb.size(), 64u * 48u * 3u);
  EXPECT_EQ(Pixel(picture, 32, 24), (Rgb{51, 102, 204}));
  EXPECT_EQ(Pixel(picture, 0, 0), (Rgb{0, 0, 255}));
}

// Breaks when vertex colours are interpolated with permuted barycentrics: a
// colour that is linear in the position must come out as that position.
TEST(Picture, VertexColoursInterpolateLinearly) {
  TriMesh mesh = Room();
  for (const Vector3d& p : mesh.vertices) {
    mesh.vertex_colors.push_back({static_cast<uint8_t>(p.x() * 60),
                                  static_cast<uint8_t>(p.y() * 60),
                                  0});
  }
  const PreviewView view = StraightDown(true);
  const SampledView sampled = SampleView(RayScene(mesh), mesh, view, 1);
  DrawOptions options;
  options.shade = false;
  const Picture picture = DrawView(sampled, mesh, VertexColors(mesh), options);
  for (int x = 22; x < 42; ++x) {
    const double depth = sampled.face[24 * 64 + x] >= 12 ? 5.2 : 6.0;
    const Vector3d p =
        view.cam_from_world.Inverse() * (depth * view.camera.Unproject(x, 24));
    EXPECT_NEAR(Pixel(picture, x, 24)[0], 60 * p.x(), 1.5);
    EXPECT_NEAR(Pixel(picture, x, 24)[1], 60 * p.y(), 1.5);
  }
}

// Breaks when the line width is not in pixels: across a long edge the missing
// brightness sums up to the width, at any distance.
TEST(Picture, WireframeHasTheWidthAskedFor) {
  TriMesh mesh;
  AddQuad({-50, -50, 0}, {50, 0, 0}, {0, 100, 0}, &mesh);
  AddQuad({0, -50, 0}, {50, 0, 0}, {0, 100, 0}, &mesh);  // they meet in x = 0
  DrawOptions options;
  options.shade = false;
  options.wireframe_rgb = Vector3f::Zero();
  for (double distance : {2.0, 7.0}) {
    for (double width : {1.0, 2.5}) {
      PreviewView view = StraightDown(false);
      view.cam_from_world.translation = Vector3d(0.03, 20, distance);
      options.wireframe_px = width;
      const Picture picture =
          DrawView(SampleView(RayScene(mesh), mesh, view, 4),
                   mesh,
                   UniformColor(Vector3f::Ones()),
                   options);
      double dark = 0;
      for (int x = 20; x < 44; ++x) {
        dark += 1 - Pixel(picture, x, 24)[0] / 255.0;
      }
      EXPECT_NEAR(dark, width, 0.15);
    }
  }
}

// Breaks when up comes out wrong with or without cameras to guide it.
TEST(PreviewViews, UpIsTheFloorsNormal) {
  TriMesh mesh = Room();
  const Pose level(Eigen::Quaterniond(Eigen::AngleAxisd(
                       0.5 * 3.14159265358979 + 0.3, Vector3d::UnitX())),
                   Vector3d::Zero());  // looks along y and 17 degrees down
  EXPECT_GT(EstimateUp(mesh, {level}).z(), 0.9999);
  EXPECT_GT(EstimateUp(mesh, {}).z(), 0.9999);
  Vector6d twist;
  twist << 0.7, -0.2, 0.4, 1, 2, 3;
  const Pose turned_from_world = ExpSe3(twist);
  for (auto& p : mesh.vertices) p = turned_from_world * p;
  EXPECT_GT(EstimateUp(mesh, {level * turned_from_world.Inverse()})
                .dot(turned_from_world.rotation * Vector3d::UnitZ()),
            0.9999);
}

// Breaks when the view from above does not frame the room, looks at its outside
// or the inside views stand outside.
TEST(PreviewViews, ShowTheRoom) {
  const TriMesh mesh = Room();
  const RayScene scene(mesh);
  PreviewOptions options;
  options.width = 160;
  options.height = 120;
  const auto views = ChooseViews(scene, mesh, {}, options);
  ASSERT_EQ(views.size(), 3u);
  for (const auto& view : views) {
    const SampledView sampled = SampleView(scene, mesh, view, 1);
    int hits = 0, floor = 0;
    for (int face : sampled.face) {
      hits += face >= 0;
      floor += face == 0 || face == 1;
    }
    EXPECT_GT(hits, 160 * 120 / 3) << view.name;
    EXPECT_GT(floor, 160 * 120 / 20) << view.name;
    const bool outside = view.cam_from_world.CenterInSource().z() > 2.5;
    EXPECT_EQ(outside, view.name == "above");
    if (outside) {  // the corners stay background: all of the room is in view
      EXPECT_LT(sampled.face.front(), 0);
      EXPECT_LT(sampled.face.back(), 0);
    }
  }
}

}  // namespace
}  // namespace facet
