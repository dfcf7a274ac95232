// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "texture/observations.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/texture/memory_sequence.h"
#include "tests/texture/texture_scenes.h"
#include "texture/atlas.h"
#include "texture/depth_moments.h"
#include "texture/fingerprint.h"
#include "texture/visibility.h"
#include "util/parallel_for.h"

namespace facet {
namespace {

using Eigen::Vector3d;

// A wall of 1.6 x 1.2 m at z = 2, seen from the origin along +z, and a square
// of 0.2 m before it at z = 1.2. Both look towards -z.
class Scene {
 public:
  explicit Scene(bool with_occluder = true, int num_frames = 3)
      : sequence(TestCalibration()) {
    AddQuadGrid(Vector3d(-0.8, -0.6, 2),
                Vector3d(1.6, 0, 0),
                Vector3d(0, 1.2, 0),
                8,
                6,
                &scene);
    if (with_occluder) {
      AddQuadGrid(Vector3d(-0.1, -0.1, 1.2),
                  Vector3d(0.2, 0, 0),
                  Vector3d(0, 0.2, 0),
                  1,
                  1,
                  &scene);
    }
    AtlasOptions options;
    options.texel_size_m = 0.01;
    atlas = BuildAtlas(scene.mesh, scene.partition, options);
    texels = SampleTexels(scene.mesh, scene.partition, atlas, {1, 0});
    for (int i = 0; i < num_frames; ++i) {
      // Camera centres (0.15 i, 0.05 i, 0).
      const Pose pose(Eigen::Quaterniond::Identity(),
                      Vector3d(-0.15 * i, -0.05 * i, 0));
      sequence.AddRendered(scene.mesh, pose, [](const Vector3d&) {
        return cv::Vec3b(100, 100, 100);
      });
    }
    off.test_occlusion = off.test_sensor_depth = off.test_angle =
        off.test_depth_edges = off.test_mesh_edges = false;
    off.min_views = 1;
  }

  Observations Compute(const VisibilityOptions& options) {
    std::vector<VisibilityCounts> of_sets;
    const std::vector<Observations> observations =
        ComputeObservations({&texels},
                            scene.Planes(),
                            RayScene(scene.mesh),
                            sequence,
                            sequence.AllFrames(),
                            sequence.AllPoses(),
                            options,
                            &of_sets);
    counts = of_sets.at(0);
    return observations.at(0);
  }

  PlaneScene scene;
  Atlas atlas;
  TexelSet texels;
  MemorySequence sequence;
  VisibilityOptions off;
  VisibilityCounts counts;
};

std::vector<uint8_t> SeenBy(const Observations& o, int k, size_t n) {
  std::vector<uint8_t> seen(n, 0);
  for (size_t i = o.begin[k]; i < o.begin[k + 1]; ++i) seen[o.texel[i]] = 1;
  return seen;
}

TEST(Observations, NoTestsButTheImageAreExact) {
  // Without switches a texel is seen iff it projects inside the margin.
  Scene s(false);
  const Observations o = s.Compute(s.off);
  for (int k = 0; k < 3; ++k) {
    const auto seen = SeenBy(o, k, s.texels.size());
    for (size_t i = 0; i < s.texels.size(); ++i) {
      const Vector3d y =
          s.sequence.AllPoses()[k] * s.texels.position[i].cast<double>();
      const Pinhole& camera = s.sequence.calibration().color;
      const auto u = camera.Project(y);
      const double slack =
          std::min({u.x() - 5, u.y() - 5, 314 - u.x(), 234 - u.y()});
      if (std::abs(slack) < 1e-3) continue;
      ASSERT_EQ(seen[i] != 0, slack > 0);
    }
  }
  EXPECT_EQ(s.counts.candidates, 3 * s.texels.size());
  EXPECT_EQ(s.counts.used, o.size());
  EXPECT_EQ(s.counts.used + s.counts.outside_image, s.counts.candidates);
}

TEST(Observations, MeshEdgesKeepAwayFromSilhouettes) {
  // What is left of wall and square is a few pixels away from the outline of
  // the square in every image, on both sides of it, and nothing else is lost
  // but the rim of the wall. Fails if the wall behind the outline, or the
  // square before it, is not tested.
  Scene s;
  VisibilityOptions options = s.off;
  options.test_mesh_edges = options.test_occlusion = true;
  const Observations o = s.Compute(options);
  EXPECT_GT(s.counts.mesh_edge, 100u);
  EXPECT_EQ(s.counts.used, o.size());
  const Pinhole& camera = s.sequence.calibration().color;
  size_t near_rim = 0;
  for (int k = 0; k < 3; ++k) {
    const Pose pose = s.sequence.AllPoses()[k];
    const Eigen::Vector2d low =
        camera.Project<double>(pose * Vector3d(-0.1, -0.1, 1.2));
    const Eigen::Vector2d high =
        camera.Project<double>(pose * Vector3d(0.1, 0.1, 1.2));
    for (size_t i = o.begin[k]; i < o.begin[k + 1]; ++i) {
      const Eigen::Vector2d u = camera.Project<double>(
          pose * s.texels.position[o.texel[i]].cast<double>());
      // Signed distance to the outline in the maximum norm.
      const double outside = std::max({low.x() - u.x(),
                                       u.x() - high.x(),
                                       low.y() - u.y(),
                                       u.y() - high.y()});
      EXPECT_GT(std::abs(outside), 2.4) << k;
      near_rim += std::abs(outside) < 8 ? 1 : 0;
    }
  }
  EXPECT_GT(near_rim, 100u);
}

TEST(Observations, OccluderHidesExactlyItsShadow) {
  // A wall texel is hidden iff the segment to the camera crosses the square.
  // Fails with a z-buffer alone (pixel errors along the silhouette).
  Scene s;
  VisibilityOptions options = s.off;
  options.test_occlusion = true;
  options.image_margin_px = 0;
  const Observations o = s.Compute(options);
  size_t hidden = 0;
  for (int k = 0; k < 3; ++k) {
    const auto seen = SeenBy(o, k, s.texels.size());
    const Vector3d c = s.sequence.AllPoses()[k].CenterInSource();
    for (size_t i = 0; i < s.texels.size(); ++i) {
      const Vector3d p = s.texels.position[i].cast<double>();
      const auto u = s.sequence.calibration().color.Project(
          Vector3d(s.sequence.AllPoses()[k] * p));
      if (!s.sequence.calibration().color.Contains(u, 0.01)) continue;
      const Vector3d x = c + (p - c) * ((1.2 - c.z()) / (p.z() - c.z()));
      const double edge = 0.1 - std::max(std::abs(x.x()), std::abs(x.y()));
      if (std::abs(edge) < 1e-4) continue;
      const bool in_shadow = s.texels.plane[i] == 0 && edge > 0;
      ASSERT_EQ(seen[i] != 0, !in_shadow) << "texel " << i;
      hidden += in_shadow;
    }
  }
  EXPECT_GT(hidden, 1000u);
  EXPECT_EQ(s.counts.occluded, hidden);
}

TEST(Observations, SensorDepthRefusesWhatItContradicts) {
  // The sensor says 10 cm behind the wall in one half of frame 0.
  Scene s(false);
  VisibilityOptions options = s.off;
  options.test_sensor_depth = true;
  options.image_margin_px = 10;  // all of it inside the depth image too
  const size_t all = s.Compute(s.off).size();
  EXPECT_GT(s.Compute(options).size(), all / 2);
  EXPECT_EQ(s.counts.depth_disagrees, 0u);
  cv::Mat& depth = s.sequence.depth(0);
  depth(cv::Rect(0, 0, 120, 180)) += 0.1f;
  const Observations o = s.Compute(options);
  EXPECT_GT(s.counts.depth_disagrees, 1000u);
  for (size_t i = o.begin[0]; i < o.begin[1]; ++i) {
    // Depth pixel 119.5 is x = -0.02 in the world (depth camera 2 cm left).
    EXPECT_GT(s.texels.position[o.texel[i]].x(), -0.02f - 0.011f);
  }
}

TEST(Observations, MissingDepthIsAChoice) {
  Scene s(false);
  s.sequence.depth(1).setTo(0);
  VisibilityOptions options = s.off;
  options.test_sensor_depth = true;
  Observations o = s.Compute(options);
  EXPECT_EQ(o.begin[1], o.begin[2]);
  EXPECT_GT(s.counts.depth_missing, 0u);
  options.allow_missing_depth = true;
  o = s.Compute(options);
  EXPECT_GT(o.begin[2], o.begin[1]);
  EXPECT_EQ(s.counts.depth_missing, 0u);
}

TEST(Observations, AngleLimitIsThatOfThePlane) {
  Scene s(false);
  VisibilityOptions options = s.off;
  options.test_angle = true;
  options.max_angle_deg = 15;
  const Observations o = s.Compute(options);
  EXPECT_GT(s.counts.grazing, 0u);
  for (int k = 0; k < 3; ++k) {
    const Vector3d c = s.sequence.AllPoses()[k].CenterInSource();
    for (size_t i = o.begin[k]; i < o.begin[k + 1]; ++i) {
      const Vector3d v = s.texels.position[o.texel[i]].cast<double>() - c;
      EXPECT_LT(std::acos(v.z() / v.norm()) * 180 / M_PI, 15.001);
    }
  }
}

TEST(Observations, BackFacesAreNeverSeen) {
  // The same wall turned over: nothing is left.
  Scene s(false);
  auto& plane = s.scene.partition.clusters[0].plane;
  plane.normal = -plane.normal;
  plane.offset = -plane.offset;
  VisibilityOptions options = s.off;
  options.test_angle = true;
  EXPECT_EQ(s.Compute(options).size(), 0u);
}

TEST(Observations, DepthEdgesKeepTheirDistance) {
  // With the occluder in view, texels within 3 depth pixels of its outline go.
  Scene s;
  VisibilityOptions options = s.off;
  options.test_depth_edges = true;
  const size_t all = s.Compute(s.off).size();
  const size_t left = s.Compute(options).size();
  EXPECT_GT(s.counts.depth_edge, 0u);
  EXPECT_EQ(left + s.counts.depth_edge, all);
}

TEST(Observations, DepthRangeAndMinViews) {
  Scene s(false);
  VisibilityOptions options = s.off;
  options.max_depth_m = 1.9;
  EXPECT_EQ(s.Compute(options).size(), 0u);
  EXPECT_EQ(s.counts.behind_or_far, s.counts.candidates);
  options = s.off;
  options.min_views = 3;
  options.image_margin_px = 90;  // smaller images, so that they see less
  const Observations o = s.Compute(options);
  std::vector<int> views(s.texels.size(), 0);
  for (uint32_t t : o.texel) ++views[t];
  for (int v : views) EXPECT_TRUE(v == 0 || v == 3);
  EXPECT_GT(s.counts.too_few_views, 0u);
  EXPECT_EQ(s.counts.used + s.counts.too_few_views + s.counts.outside_image,
            s.counts.candidates);
}

// The milder verdict forgives what the sensor did not see, not what hides a
// point. Breaks if a verdict depends on the points that are tested with it, if
// missing depth hides a point, or if the square before the wall does not.
TEST(FrameView, MildVerdictForgivesMissingDepthOnly) {
  Scene s;
  VisibilityOptions options;
  options.min_views = 1;
  options.test_mesh_edges = false;
  cv::Mat depth = s.sequence.depth(0).clone();
  depth(cv::Rect(0, 0, 120, 180)).setTo(0);
  const RayScene rays(s.scene.mesh);
  const FrameView view(
      s.sequence.calibration(), s.sequence.AllPoses()[0], depth, rays, options);
  SightPoints points(s.texels.size());
  for (size_t i = 0; i < s.texels.size(); ++i) {
    points.Set(i, s.texels.position[i], s.texels.position[i]);
  }
  int seen[kNumSights] = {}, mild[kNumSights] = {};
  for (size_t i = 0; i < s.texels.size(); ++i) {
    const size_t begin = i / 7 * 7;
    SightBatch batch =
        points.Batch(begin, std::min(begin + 7, s.texels.size()), {0, 0, -1});
    SightBatch alone = points.Batch(i, i + 1, {0, 0, -1});
    view.Test(&batch);
    view.Test(&alone);
    const Sight sight = alone.sight[0];
    const bool may_see = alone.may_see[0];
    ASSERT_EQ(sight, batch.sight[i - begin]);
    ASSERT_EQ(may_see, batch.may_see[i - begin]);
    ++seen[static_cast<int>(sight)];
    mild[static_cast<int>(sight)] += may_see;
    // Behind the square as seen from the origin, well inside its shadow.
    const Eigen::Vector3f& p = s.texels.position[i];
    const bool hidden =
        p.z() > 1.5f && std::abs(p.x()) < 0.15f && std::abs(p.y()) < 0.15f;
    if (hidden) {
      EXPECT_FALSE(may_see);
      EXPECT_NE(sight, Sight::kVisible);
    }
  }
  const auto at = [](Sight sight) { return static_cast<int>(sight); };
  EXPECT_EQ(mild[at(Sight::kVisible)], seen[at(Sight::kVisible)]);
  EXPECT_EQ(mild[at(Sight::kOccluded)], 0);
  EXPECT_EQ(mild[at(Sight::kOutsideImage)], 0);
  EXPECT_GT(seen[at(Sight::kDepthMissing)], 1000);
  EXPECT_GT(mild[at(Sight::kDepthMissing)],
            seen[at(Sight::kDepthMissing)] * 3 / 4);
  // The same point from behind.
  SightPoints point(1);
  point.Set(0, {0.5f, 0, 2}, {0.5f, 0, 2});
  SightBatch batch = point.Batch(0, 1, {0, 0, 1});
  view.Test(&batch);
  EXPECT_EQ(batch.sight[0], Sight::kGrazing);
  EXPECT_FALSE(batch.may_see[0]);
}

// Breaks if a part of the frozen set is left out of the hash: runs on different
// observations would then be compared.
TEST(Observations, FingerprintSeesEveryChange) {
  Scene s;
  const Observations o = s.Compute(s.off);
  const std::string print = ObservationFingerprint(s.texels, o);
  EXPECT_EQ(print.size(), 16u);
  EXPECT_EQ(print, ObservationFingerprint(s.texels, s.Compute(s.off)));

  // One keyframe's observation given to its neighbour: ids stay the same.
  Observations moved = o;
  ++moved.begin[1];
  EXPECT_NE(print, ObservationFingerprint(s.texels, moved));
  Observations other = o;
  ++other.texel.back();
  EXPECT_NE(print, ObservationFingerprint(s.texels, other));
  TexelSet texels = s.texels;
  texels.position[0].x() += 1e-6f;
  EXPECT_NE(print, ObservationFingerprint(texels, o));
  texels = s.texels;
  ++texels.plane[0];
  EXPECT_NE(print, ObservationFingerprint(texels, o));
}

TEST(Observations, SameAtAnyThreadCount) {
  Scene s;
  VisibilityOptions options;
  options.min_views = 1;
  SetNumThreads(1);
  const Observations one = s.Compute(options);
  SetNumThreads(4);
  const Observations four = s.Compute(options);
  SetNumThreads(0);
  EXPECT_TRUE(one.begin == four.begin);
  EXPECT_TRUE(one.texel == four.texel);
  EXPECT_GT(one.size(), 0u);
}

TEST(DepthMoments, VanishOnTheTruePlanesOfTheRightCamera) {
  // Exact depth of a wall and a square, two cameras apart: the plane of each
  // cluster, taken to the colour camera, is in the kernel of its moment; moved
  // by 1 cm it costs that squared for every sample. Fails if samples go to the
  // wrong cluster or stay in the depth camera.
  Scene s;
  DepthMomentOptions options;
  options.step_px = 4;
  const auto moments = ComputeDepthMoments(s.scene.partition,
                                           s.scene.Planes(),
                                           RayScene(s.scene.mesh),
                                           s.sequence,
                                           s.sequence.AllFrames(),
                                           s.sequence.AllPoses(),
                                           options);
  ASSERT_EQ(moments.size(), 6u);  // both planes in all three frames
  for (const DepthMoment& d : moments) {
    const Pose pose = s.sequence.AllPoses()[d.keyframe];
    const Plane& plane = s.scene.partition.clusters[d.plane].plane;
    Eigen::Vector4d psi;
    psi.head<3>() = pose.rotation * plane.normal;
    psi[3] = plane.offset - psi.head<3>().dot(pose.translation);
    const double total = d.moment(3, 3);  // sum of the weights
    EXPECT_GT(d.samples, 12u);
    EXPECT_NEAR(psi.dot(d.moment * psi) / total, 0, 1e-10);
    psi[3] += 0.01;
    EXPECT_NEAR(psi.dot(d.moment * psi) / total, 1e-4, 1e-8);
  }
}

// Breaks if texels lose some of their views but not all, or if the
// keyframes' ranges do not follow.
TEST(Observations, ThinningKeepsTexelsWhole) {
  Observations all;
  all.begin = {0, 10, 16};
  all.texel = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 0, 2, 3, 4, 6, 9};
  const Observations thin = Thinned(all, 6);  // every third
  EXPECT_EQ(thin.begin, (std::vector<size_t>{0, 4, 8}));
  EXPECT_EQ(thin.texel, (std::vector<uint32_t>{0, 3, 6, 9, 0, 3, 6, 9}));
  EXPECT_EQ(Thinned(all, 16).texel, all.texel);
}

}  // namespace
}  // namespace facet
