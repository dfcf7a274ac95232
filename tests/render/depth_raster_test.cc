// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "render/depth_raster.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "util/random.h"

namespace facet {
namespace {

using Eigen::Vector3d;

const Pinhole kCamera = {110, 105, 80.3, 59.6, 161, 121};

// A box around the origin whose sides are grids with displaced inner vertices.
TriMesh BumpyBox(double half, int cells, double bump, uint64_t seed) {
  Random random(seed);
  TriMesh mesh;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-half, half}) {
      const int base = static_cast<int>(mesh.vertices.size());
      for (int i = 0; i <= cells; ++i) {
        for (int j = 0; j <= cells; ++j) {
          const bool inner = i > 0 && j > 0 && i < cells && j < cells;
          Vector3d x;
          x[axis] = side + (inner ? bump * random.Uniform(-1, 1) : 0);
          x[(axis + 1) % 3] = half * (2.0 * i / cells - 1);
          x[(axis + 2) % 3] = half * (2.0 * j / cells - 1);
          mesh.vertices.push_back(x);
        }
      }
      for (int i = 0; i < cells; ++i) {
        for (int j = 0; j < cells; ++j) {
          const int a = base + i * (cells + 1) + j, b = a + cells + 1;
          mesh.faces.push_back({a, b, a + 1});
          mesh.faces.push_back({a + 1, b, b + 1});
        }
      }
    }
  }
  return mesh;
}

Pose Somewhere(uint64_t seed, double reach) {
  Random random(seed);
  Vector6d twist;
  for (int i = 0; i < 3; ++i) twist[i] = random.Uniform(-2, 2);
  for (int i = 3; i < 6; ++i) twist[i] = random.Uniform(-reach, reach);
  return ExpSe3(twist);
}

// Breaks when a pixel between two triangles is left out, when triangles that
// pass behind the camera are dropped or wrap around, or when 1/z is wrong.
TEST(RasterizeDepth, SeesTheInsideOfARoomAsRaysDo) {
  const TriMesh mesh = BumpyBox(2, 9, 0.1, 1);
  const RayScene scene(mesh);
  for (uint64_t seed = 0; seed < 8; ++seed) {
    const Pose cam_from_world = Somewhere(seed, 0.9);
    const std::vector<float> depth =
        RasterizeDepth(scene, kCamera, cam_from_world);
    const DepthRender rays = RenderDepth(scene, kCamera, cam_from_world);
    ASSERT_EQ(depth.size(), rays.depth.size());
    int different = 0;
    for (size_t i = 0; i < depth.size(); ++i) {
      ASSERT_GT(depth[i], 0) << "pixel " << i << ", seed " << seed;
      different += std::abs(depth[i] - rays.depth[i]) > 1e-4f * depth[i];
    }
    // Bumps have outlines, but few.
    EXPECT_LT(different, 0.005 * static_cast<double>(depth.size()));
  }
}

// Breaks when the nearest of several surfaces does not win, when one side of a
// triangle is not drawn, or pixels beyond a triangle are.
TEST(RasterizeDepth, ScatteredTrianglesAgreeButForOutlines) {
  Random random(3);
  TriMesh mesh;
  for (int i = 0; i < 400; ++i) {
    const Vector3d center(
        random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(-1, 1));
    for (int k = 0; k < 3; ++k) {
      mesh.vertices.push_back(center + 0.3 * Vector3d(random.Normal(),
                                                      random.Normal(),
                                                      random.Normal()));
    }
    mesh.faces.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  const RayScene scene(mesh);
  const Pose cam_from_world(Eigen::Quaterniond::Identity(),
                            Vector3d(0.1, 0, 2.0));
  const std::vector<float> depth =
      RasterizeDepth(scene, kCamera, cam_from_world);
  const DepthRender rays = RenderDepth(scene, kCamera, cam_from_world);
  int hits = 0, different = 0;
  for (size_t i = 0; i < depth.size(); ++i) {
    hits += depth[i] > 0;
    different += std::abs(depth[i] - rays.depth[i]) > 1e-4f * depth[i];
  }
  EXPECT_GT(hits, 5000);
  EXPECT_LT(different, 0.005 * hits);
}

// Breaks when corners that meet a pixel centre or row exactly are lost, or the
// border of the image is exceeded.
TEST(RasterizeDepth, FillsExactCornersAndNothingElse) {
  TriMesh mesh;  // pixels 2 to 5 in both directions, at z = 2
  const Pinhole camera = {10, 10, 0, 0, 9, 8};
  mesh.vertices = {{0.4, 0.4, 2}, {1, 0.4, 2}, {1, 1, 2}, {0.4, 1, 2}};
  mesh.faces = {{0, 1, 2}, {0, 2, 3}};
  const std::vector<float> depth =
      RasterizeDepth(RayScene(mesh), camera, Pose());
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 9; ++x) {
      const bool inside = x >= 2 && x <= 5 && y >= 2 && y <= 5;
      EXPECT_EQ(depth[9 * y + x] > 0, inside) << x << " " << y;
      if (inside) {
        EXPECT_NEAR(depth[9 * y + x], 2, 1e-6);
      }
    }
  }
}

// Breaks when something behind the camera, or seen edge-on, is drawn.
TEST(RasterizeDepth, NothingBehindOrEdgeOn) {
  TriMesh mesh;
  mesh.vertices = {
      {-1, -1, -2}, {1, -1, -2}, {0, 1, -2}, {0, 0, 1}, {0, 1, 2}, {0, -1, 2}};
  mesh.faces = {{0, 1, 2}, {3, 4, 5}};
  for (const float z : RasterizeDepth(RayScene(mesh), kCamera, Pose())) {
    EXPECT_EQ(z, 0);
  }
}

}  // namespace
}  // namespace facet
