// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "render/ray_scene.h"

#include <gtest/gtest.h>

#include <cmath>

#include "util/parallel_for.h"
#include "util/random.h"

namespace facet {
namespace {

using Eigen::Vector3d;

// An axis-aligned box, two triangles a side, normals outwards.
TriMesh Box(const Vector3d& low, const Vector3d& high) {
  TriMesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.vertices.emplace_back(i & 1 ? high.x() : low.x(),
                               i & 2 ? high.y() : low.y(),
                               i & 4 ? high.z() : low.z());
  }
  const int quads[6][4] = {{0, 4, 6, 2},
                           {1, 3, 7, 5},
                           {0, 1, 5, 4},
                           {2, 6, 7, 3},
                           {0, 2, 3, 1},
                           {4, 5, 7, 6}};
  for (const auto& q : quads) {
    mesh.faces.push_back({q[0], q[1], q[2]});
    mesh.faces.push_back({q[0], q[2], q[3]});
  }
  return mesh;
}

TriMesh RandomTriangles(int count, uint64_t seed) {
  Random random(seed);
  TriMesh mesh;
  for (int i = 0; i < count; ++i) {
    const Vector3d center(
        random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(-1, 1));
    for (int k = 0; k < 3; ++k) {
      mesh.vertices.push_back(center + 0.2 * Vector3d(random.Normal(),
                                                      random.Normal(),
                                                      random.Normal()));
    }
    mesh.faces.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return mesh;
}

Vector3d PointOf(const TriMesh& mesh, int face, double u, double v) {
  const auto& f = mesh.faces[face];
  return (1 - u - v) * mesh.vertices[f[0]] + u * mesh.vertices[f[1]] +
         v * mesh.vertices[f[2]];
}

// Breaks when t is not in units of `direction`, when barycentrics are permuted
// or when the far side of the box wins.
TEST(RayScene, HitsBoxWhereTheSlabTestSays) {
  const Vector3d low(-1, -2, -3), high(1, 2, 3);
  const TriMesh box = Box(low, high);
  const RayScene scene(box);
  Random random(1);
  for (int i = 0; i < 1000; ++i) {
    const Vector3d origin(
        random.Uniform(-9, 9), random.Uniform(-9, 9), random.Uniform(4, 9));
    const Vector3d target(
        random.Uniform(-1, 1), random.Uniform(-2, 2), random.Uniform(-3, 3));
    const Vector3d direction = random.Uniform(0.1, 3) * (target - origin);
    double t_in = -1e30;
    for (int k = 0; k < 3; ++k) {
      t_in = std::max(t_in,
                      std::min((low[k] - origin[k]) / direction[k],
                               (high[k] - origin[k]) / direction[k]));
    }
    const RayHit hit = scene.Intersect(origin, direction);
    ASSERT_GE(hit.face, 0);
    EXPECT_NEAR(hit.t, t_in, 1e-5);
    EXPECT_NEAR(
        (PointOf(box, hit.face, hit.u, hit.v) - (origin + hit.t * direction))
            .norm(),
        0,
        1e-6);
  }
}

// Breaks when a ray slips through a shared edge or vertex (no robust mode).
TEST(RayScene, RaysThroughEdgesAndVerticesNeverMiss) {
  const TriMesh box = Box(Vector3d(-1, -1, -1), Vector3d(1, 1, 1));
  const RayScene scene(box);
  Random random(2);
  for (int i = 0; i < 2000; ++i) {
    // From the inside, at a vertex, or a point on a triangle's edge.
    const Vector3d origin(random.Uniform(-0.9, 0.9),
                          random.Uniform(-0.9, 0.9),
                          random.Uniform(-0.9, 0.9));
    const auto& f = box.faces[random.Index(box.faces.size())];
    const double along = i % 4 ? random.Uniform() : 0.0;
    const Vector3d target = (1 - along) * box.vertices[f[i % 3]] +
                            along * box.vertices[f[(i + 1) % 3]];
    EXPECT_GE(scene.Intersect(origin, target - origin).face, 0);
  }
}

// Breaks when t_min or t_max is ignored or read in other units.
TEST(RayScene, RespectsTheIntervalOfT) {
  const RayScene scene(Box(Vector3d(-1, -1, 2), Vector3d(1, 1, 4)));
  const Vector3d origin(0.1, 0.2, 0), direction(0, 0, 2);
  EXPECT_NEAR(scene.Intersect(origin, direction).t, 1, 1e-9);
  EXPECT_NEAR(scene.Intersect(origin, direction, 1.1).t, 2, 1e-9);
  EXPECT_EQ(scene.Intersect(origin, direction, 0, 0.9).face, -1);
  EXPECT_TRUE(scene.Occluded(origin, direction, 0, 1.1));
  EXPECT_FALSE(scene.Occluded(origin, direction, 0, 0.9));
  EXPECT_FALSE(scene.Occluded(origin, direction, 1.1, 1.9));
  EXPECT_FALSE(scene.Occluded(origin, -direction, 0, 100));
}

// Breaks when a miss is reported as a hit or an empty mesh crashes.
TEST(RayScene, EmptyMeshIsNeverHit) {
  const RayScene scene(TriMesh{});
  EXPECT_EQ(scene.Intersect(Vector3d::Zero(), Vector3d::UnitX()).face, -1);
  EXPECT_FALSE(scene.Occluded(Vector3d::Zero(), Vector3d::UnitX(), 0, 10));
  EXPECT_EQ(scene.NearestPoint(Vector3d::Zero()).face, -1);
}

// Breaks when the closest-point regions of a triangle are wrong or the search
// radius shrinks too fast: compares with dense sampling of every triangle.
TEST(RayScene, NearestPointBeatsEverySample) {
  const TriMesh mesh = RandomTriangles(40, 3);
  const RayScene scene(mesh);
  Random random(4);
  for (int i = 0; i < 100; ++i) {
    const Vector3d p(
        random.Uniform(-2, 2), random.Uniform(-2, 2), random.Uniform(-2, 2));
    const NearestHit hit = scene.NearestPoint(p);
    ASSERT_GE(hit.face, 0);
    EXPECT_NEAR(
        (hit.point - PointOf(mesh, hit.face, hit.u, hit.v)).norm(), 0, 1e-12);
    EXPECT_NEAR((hit.point - p).norm(), hit.distance, 1e-12);
    double sampled = 1e30;
    for (int f = 0; f < 40; ++f) {
      for (int a = 0; a <= 20; ++a) {
        for (int b = 0; a + b <= 20; ++b) {
          sampled = std::min(sampled,
                             (PointOf(mesh, f, a / 20.0, b / 20.0) - p).norm());
        }
      }
    }
    EXPECT_LE(hit.distance, sampled + 1e-12);
    EXPECT_GE(hit.distance, sampled - 0.05);
  }
}

// Breaks when the distance of points at a known offset from a side is wrong or
// max_distance is not a limit.
TEST(RayScene, NearestPointOfABoxIsExact) {
  const RayScene scene(Box(Vector3d(-1, -1, -1), Vector3d(1, 1, 1)));
  EXPECT_NEAR(scene.NearestPoint({0.3, 0.4, 1.25}).distance, 0.25, 1e-12);
  EXPECT_NEAR(scene.NearestPoint({2, 2, 0.5}).distance, std::sqrt(2), 1e-12);
  EXPECT_NEAR(scene.NearestPoint({2, 2, 2}).distance, std::sqrt(3), 1e-12);
  EXPECT_EQ(scene.NearestPoint({0, 0, 1.5}, 0.4).face, -1);
  EXPECT_GE(scene.NearestPoint({0, 0, 1.5}, 0.6).face, 0);
}

// Breaks when RenderDepth returns range instead of z, shifts pixels by half, or
// swaps the direction of the pose.
TEST(RenderDepth, FrontoParallelPlaneHasOneDepth) {
  TriMesh mesh;  // z = 2.5 in the camera, much larger than the view
  mesh.vertices = {{-9, -9, 2.5}, {9, -9, 2.5}, {9, 9, 2.5}, {-9, 9, 2.5}};
  mesh.faces = {{0, 2, 1}, {0, 3, 2}};
  Vector6d twist;
  twist << 0.3, -0.5, 0.9, 0.4, -0.2, 0.7;
  const Pose cam_from_world = ExpSe3(twist);
  for (auto& x : mesh.vertices) x = cam_from_world.Inverse() * x;
  const Pinhole camera = {70, 65, 30.2, 21.7, 61, 43};
  const DepthRender render =
      RenderDepth(RayScene(mesh), camera, cam_from_world);
  ASSERT_EQ(render.depth.size(), 61u * 43u);
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const size_t i = static_cast<size_t>(y) * camera.width + x;
      ASSERT_GE(render.face[i], 0);
      EXPECT_NEAR(render.depth[i], 2.5, 1e-5);
      const Vector3d point =
          cam_from_world *
          PointOf(mesh, render.face[i], render.u[i], render.v[i]);
      const Eigen::Vector2d pixel = camera.Project(point);
      EXPECT_NEAR(pixel.x(), x, 1e-3);
      EXPECT_NEAR(pixel.y(), y, 1e-3);
    }
  }
}

// Breaks when packets and single rays disagree, or threads change anything.
TEST(RenderDepth, EqualsSingleRaysAtAnyThreadCount) {
  const TriMesh mesh = RandomTriangles(300, 5);
  const RayScene scene(mesh);
  const Pinhole camera = {50, 50, 32, 24, 67, 49};
  const Pose cam_from_world(Eigen::Quaterniond::Identity(),
                            Vector3d(0.1, 0, 2.5));
  const DepthRender two = RenderDepth(scene, camera, cam_from_world);
  const int before = NumThreads();
  SetNumThreads(1);
  const RayScene rebuilt(mesh);
  const DepthRender one = RenderDepth(rebuilt, camera, cam_from_world);
  SetNumThreads(before);
  EXPECT_EQ(one.face, two.face);
  EXPECT_EQ(one.depth, two.depth);
  EXPECT_EQ(one.u, two.u);
  const Vector3d origin = cam_from_world.CenterInSource();
  int hits = 0, different = 0;
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const size_t i = static_cast<size_t>(y) * camera.width + x;
      const RayHit hit = scene.Intersect(
          origin, cam_from_world.Inverse().rotation * camera.Unproject(x, y));
      if (hit.face != one.face[i]) {
        ++different;  // float32 rounding at silhouettes
      } else if (hit.face >= 0) {
        ++hits;
        EXPECT_NEAR(hit.t, one.depth[i], 1e-4);
      }
    }
  }
  EXPECT_GT(hits, 500);
  EXPECT_LE(different, 2);
}

}  // namespace
}  // namespace facet
