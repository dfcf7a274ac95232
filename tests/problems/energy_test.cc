// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "problems/energy.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "mesh/covariance.h"
#include "problems/color_step.h"
#include "problems/explicit_problem.h"
#include "tests/support/tiny_scene.h"
#include "util/random.h"

namespace facet {
namespace {

// A state away from the optimum, with warps.
ReconState PerturbedState(const TinyScene& scene) {
  ReconState state = scene.truth;
  PerturbPoses(0.01, 0.01, 1, &state);
  PerturbPlanes(0.01, 0.004, 2, &state);
  Random random(3);
  for (double& f : state.warps) f = 0.4 * random.Normal();
  return state;
}

EnergyWeights SomeWeights() {
  EnergyWeights weights;
  weights.lambda1 = 170;
  weights.lambda2 = 0.1;
  weights.texel_weight = 4;
  return weights;
}

// The paper's energy against one Ceres residual block an observation. Breaks if
// a weight, a 1/2, a keyframe's texel list or the origin shift is wrong.
TEST(Energy, IsTwiceTheCostOfTheExplicitProblem) {
  TinySceneOptions options;
  options.texel_spacing_m = 0.1;
  TinyScene scene = MakeTinyScene(options);
  ReconState state = PerturbedState(scene);
  AddDepthMoments(&scene);
  for (const bool pose_prior : {false, true}) {
    EnergyWeights weights = SomeWeights();
    weights.pose_prior = pose_prior;
    weights.depth_weight = 0.03;
    const EnergyTerms terms = EvaluateEnergy(scene.problem, weights, state);
    ExplicitProblem reference(scene.problem, weights, &state);
    EXPECT_NEAR(
        2 * reference.Cost(), terms.Objective(), 1e-5 * terms.Objective());
    EXPECT_EQ(terms.e_prior > 0, pose_prior);
    EXPECT_GT(terms.e_depth, 0);
    EXPECT_EQ(terms.observations, scene.problem.observations.size());
    EXPECT_DOUBLE_EQ(terms.e_tex,
                     terms.e_c + 170 * terms.e_p + 0.1 * terms.e_s);
  }
}

// x -> G x for mesh, planes, poses and the prior's centre. Texel positions are
// floats: 2e-7 m of rounding. Breaks if a frame is mixed up anywhere.
TEST(Energy, DoesNotChangeWhenTheWorldMoves) {
  TinyScene scene = MakeTinyScene();
  ReconState state = PerturbedState(scene);
  const EnergyWeights weights = SomeWeights();
  const EnergyTerms before = EvaluateEnergy(scene.problem, weights, state);

  Vector6d xi;
  xi << 0.7, -1.1, 0.4, 1.5, -0.8, 0.9;
  const Pose g = ExpSe3(xi);
  TextureProblem& moved = scene.problem;
  for (Eigen::Vector3f& p : moved.texels.position) {
    p = (g * p.cast<double>()).cast<float>();
  }
  for (int j = 0; j < moved.NumPlanes(); ++j) {
    moved.anchors[j] = g * moved.anchors[j];
    Eigen::Map<Eigen::Vector3d> normal(state.planes.data() + 4 * j);
    normal = g.rotation * Eigen::Vector3d(normal);
  }
  for (int k = 0; k < moved.NumKeyframes(); ++k) {
    PoseToBlock(state.CamFromWorld(k) * g.Inverse(),
                state.poses.data() + kPoseSize * k);
    moved.initial_cam_from_world[k] =
        moved.initial_cam_from_world[k] * g.Inverse();
  }
  FinishTextureProblem(&moved);
  const EnergyTerms after = EvaluateEnergy(moved, weights, state);
  EXPECT_NEAR(after.e_c, before.e_c, 1e-5 * before.e_c);
  EXPECT_NEAR(after.e_p, before.e_p, 1e-4 * before.e_p);
  EXPECT_NEAR(after.e_prior, before.e_prior, 1e-9 * before.e_prior);
  EXPECT_DOUBLE_EQ(after.e_s, before.e_s);
}

// Keyframes in reverse order. Breaks if a list by keyframe is read by position
// in another one.
TEST(Energy, DoesNotChangeWhenKeyframesAreRenumbered) {
  TinyScene scene = MakeTinyScene();
  ReconState state = PerturbedState(scene);
  const EnergyWeights weights = SomeWeights();
  const EnergyTerms before = EvaluateEnergy(scene.problem, weights, state);

  TextureProblem& p = scene.problem;
  const ReconState old = state;
  const Observations observations = p.observations;
  const int n = p.NumKeyframes();
  std::reverse(p.images.begin(), p.images.end());
  std::reverse(p.raw_images.begin(), p.raw_images.end());
  std::reverse(p.initial_cam_from_world.begin(),
               p.initial_cam_from_world.end());
  p.observations.begin = {0};
  p.observations.texel.clear();
  const size_t num_warp = old.warps.size() / n;
  for (int k = 0; k < n; ++k) {
    const int from = n - 1 - k;
    p.observations.texel.insert(
        p.observations.texel.end(),
        observations.texel.begin() + observations.begin[from],
        observations.texel.begin() + observations.begin[from + 1]);
    p.observations.begin.push_back(p.observations.texel.size());
    std::copy_n(old.poses.begin() + 7 * from, 7, state.poses.begin() + 7 * k);
    std::copy_n(old.warps.begin() + num_warp * from,
                num_warp,
                state.warps.begin() + num_warp * k);
  }
  FinishTextureProblem(&p);
  const EnergyTerms after = EvaluateEnergy(p, weights, state);
  EXPECT_NEAR(after.e_c, before.e_c, 1e-12 * before.e_c);
  EXPECT_NEAR(after.e_p, before.e_p, 1e-12 * before.e_p);
  EXPECT_NEAR(after.e_prior, before.e_prior, 1e-12 * before.e_prior);
}

TEST(Energy, PlaneTermCountsAllTexelsOfSeenPlanes) {
  // A plane of which one texel is seen is held by all its texels, those in the
  // edge margin too; one that nobody sees by none. Breaks if only seen texels
  // count: such a plane could then tilt freely.
  TinyScene scene = MakeTinyScene();
  TextureProblem& problem = scene.problem;
  const int last = problem.NumPlanes() - 1;
  std::vector<size_t> of_plane(problem.NumPlanes(), 0);
  for (const int plane : problem.texels.plane) ++of_plane[plane];
  Observations kept;
  std::vector<bool> met(problem.NumPlanes(), false);
  kept.begin.push_back(0);
  for (int k = 0; k < problem.NumKeyframes(); ++k) {
    for (size_t i = problem.observations.begin[k];
         i < problem.observations.begin[k + 1];
         ++i) {
      const uint32_t id = problem.observations.texel[i];
      const int plane = problem.texels.plane[id];
      if (plane == last || met[plane]) continue;
      met[plane] = true;
      kept.texel.push_back(id);
    }
    kept.begin.push_back(kept.texel.size());
  }
  problem.observations = kept;
  problem.texels.margin_position = {problem.texels.position[0]};
  problem.texels.margin_plane = {0};
  FinishTextureProblem(&problem);
  for (int j = 0; j < last; ++j) {
    EXPECT_EQ(problem.plane_texels[j], 1u);
    EXPECT_EQ(problem.moments[j](3, 3),
              static_cast<double>(of_plane[j] + (j == 0 ? 1 : 0)));
  }
  EXPECT_GT(of_plane[last], 0u);
  EXPECT_EQ(problem.moments[last].norm(), 0);
}

// A wavy strip as the dense surface of every plane: E_p is the density times
// the integral of squared distances, here by the exact rule of three edge
// midpoints, and its gradient vanishes on the strip's own least-squares plane.
// Breaks if the anchor, the area or the covariance is mixed up.
TEST(Energy, PlaneTermOfTheDenseMeshIsItsIntegral) {
  TinyScene scene = MakeTinyScene();
  TextureProblem& problem = scene.problem;
  const Eigen::Vector3d e1(0.6, 0.8, 0), e2(-0.8, 0.6, 0), e3(0, 0, 1);
  const auto at = [&](int i, int k) -> Eigen::Vector3d {
    return Eigen::Vector3d(2, -1, 0.5) + 0.1 * i * e1 + 0.1 * k * e2 +
           0.01 * std::sin(1.3 * i + 0.7 * k) * e3;
  };
  const Eigen::Vector3d n = Eigen::Vector3d(0.1, -0.2, 1).normalized();
  SurfaceMoments surface;
  double integral = 0;
  const double w = -n.dot(Eigen::Vector3d(2, -1, 0.5));
  const auto add = [&](const Eigen::Vector3d& a,
                       const Eigen::Vector3d& b,
                       const Eigen::Vector3d& c) {
    surface = Union(surface, TriangleMoments(a, b, c));
    for (const auto& twice_middle : {a + b, b + c, c + a}) {
      const double distance = n.dot(0.5 * twice_middle) + w;
      integral += 0.5 * (b - a).cross(c - a).norm() * distance * distance / 3;
    }
  };
  for (int i = 0; i < 8; ++i) {
    for (int k = 0; k < 5; ++k) {
      add(at(i, k), at(i + 1, k), at(i + 1, k + 1));
      add(at(i, k), at(i + 1, k + 1), at(i, k + 1));
    }
  }
  problem.surface.assign(problem.NumPlanes(), surface);
  problem.texels_per_m2 = 1600;
  FinishTextureProblem(&problem);
  ReconState state = scene.truth;
  const auto set_planes = [&](const Eigen::Vector3d& normal, double offset) {
    for (int j = 0; j < problem.NumPlanes(); ++j) {
      Eigen::Map<Eigen::Vector4d> phi(state.planes.data() + kPlaneSize * j);
      phi << normal, offset + normal.dot(problem.anchors[j]);
    }
  };
  set_planes(n, w);
  const double expected = 1600 * integral * problem.NumPlanes();
  EXPECT_NEAR(EvaluateEnergy(problem, EnergyWeights(), state).e_p,
              expected,
              1e-9 * expected);
  const Plane best = FitPlane(surface, n);
  const auto e_p = [&](double tilt, double shift) {
    const Eigen::Vector3d turned =
        (best.normal + tilt * best.normal.unitOrthogonal()).normalized();
    set_planes(turned, shift - turned.dot(surface.centroid));
    return EvaluateEnergy(problem, EnergyWeights(), state).e_p;
  };
  for (const double step : {1e-4, -1e-4}) {
    EXPECT_GT(e_p(step, 0), e_p(0, 0));
    EXPECT_GT(e_p(0, step), e_p(0, 0));
  }
}

// lambda1 = E_c / E_p at the start (paper, Sec. 3.3), and its two edge cases.
TEST(Energy, InitialLambda1BalancesTheTerms) {
  TinyScene scene = MakeTinyScene();
  ReconState state = scene.truth;
  PerturbPoses(0.005, 0.01, 1, &state);
  const EnergyWeights weights = StartFrom(&state, &scene.problem);
  const EnergyTerms start = EvaluateEnergy(scene.problem, weights, state);
  EXPECT_NEAR(weights.lambda1 * start.e_p, start.e_c, 1e-9 * start.e_c);

  // A flat mesh: E_p is floored at (0.5 mm)^2 a texel, lambda1 stays finite.
  TinySceneOptions flat;
  flat.relief_m = 0;
  TinyScene flat_scene = MakeTinyScene(flat);
  ReconState flat_state = flat_scene.truth;
  PerturbPoses(0.005, 0.01, 1, &flat_state);
  const EnergyWeights flat_weights =
      StartFrom(&flat_state, &flat_scene.problem);
  const size_t texels =
      flat_scene.problem.texels.size();  // all planes are seen
  const double e_c =
      EvaluateEnergy(flat_scene.problem, flat_weights, flat_state).e_c;
  EXPECT_NEAR(flat_weights.lambda1,
              e_c / (static_cast<double>(texels) * 0.0005 * 0.0005),
              1e-9 * flat_weights.lambda1);

  // Grey walls: E_c = 0.
  TinySceneOptions blank;
  blank.contrast = 0;
  TinyScene blank_scene = MakeTinyScene(blank);
  ReconState blank_state = blank_scene.truth;
  EXPECT_EQ(StartFrom(&blank_state, &blank_scene.problem).lambda1, 1e3);
}

// Images moved half a pixel out of view: clamped samples are counted, and the
// set of observations stays as it is.
TEST(Energy, CountsClampedSamplesAndKeepsThem) {
  TinyScene scene = MakeTinyScene();
  ReconState state = scene.truth;
  EXPECT_EQ(EvaluateEnergy(scene.problem, {}, state).clamped, 0u);
  PerturbPoses(0.3, 0, 1, &state);
  const EnergyTerms terms = EvaluateEnergy(scene.problem, {}, state);
  EXPECT_GT(terms.clamped, 0u);
  EXPECT_EQ(terms.observations, scene.problem.observations.size());
  EXPECT_NEAR(terms.ClampedShare(),
              static_cast<double>(terms.clamped) / terms.observations,
              1e-12);
}

// With mean colours and equal image sets, rms_grey is the rms of the residuals
// in grey levels.
TEST(Energy, RmsGreyAgreesWithTheResiduals) {
  TinyScene scene = MakeTinyScene();
  ReconState state = scene.truth;
  PerturbPoses(0.01, 0.01, 1, &state);
  SolveColors(scene.problem, &state);
  EnergyWeights weights = SomeWeights();
  const EnergyTerms terms = EvaluateEnergy(scene.problem, weights, state, true);
  EXPECT_NEAR(
      terms.rms_grey, 255 * terms.RmsIntensity(), 1e-5 * terms.rms_grey);
}

// The tables of the problem: every observation is in exactly one segment, of
// its own keyframe and tile, and building them again changes nothing.
TEST(TextureProblem, SegmentsTileTheObservations) {
  TinySceneOptions options;
  options.texel_spacing_m = 0.02;  // more than one tile a plane
  TinyScene scene = MakeTinyScene(options);
  TextureProblem& p = scene.problem;
  ASSERT_GT(p.tiles.size(), 3u);
  for (int repeat = 0; repeat < 2; ++repeat) {
    std::vector<int> visits(p.observations.size(), 0);
    for (const TexelTile& tile : p.tiles) {
      EXPECT_LE(tile.texel_end - tile.texel_begin, kTileTexels);
      for (size_t s = tile.segment_begin; s < tile.segment_end; ++s) {
        const TileSegment& segment = p.segments[s];
        EXPECT_GE(segment.begin, p.observations.begin[segment.keyframe]);
        EXPECT_LE(segment.end, p.observations.begin[segment.keyframe + 1]);
        for (size_t i = segment.begin; i < segment.end; ++i) {
          ++visits[i];
          const uint32_t texel = p.observations.texel[i];
          EXPECT_GE(texel, tile.texel_begin);
          EXPECT_LT(texel, tile.texel_end);
          EXPECT_EQ(p.texels.plane[texel], tile.plane);
        }
      }
    }
    EXPECT_EQ(std::count(visits.begin(), visits.end(), 1),
              static_cast<std::ptrdiff_t>(visits.size()));
    const size_t tiles = p.tiles.size(), segments = p.segments.size();
    FinishTextureProblem(&p);
    EXPECT_EQ(p.tiles.size(), tiles);
    EXPECT_EQ(p.segments.size(), segments);
  }
}

}  // namespace
}  // namespace facet
