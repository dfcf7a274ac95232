// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "terms/manhattan.h"

#include <gtest/gtest.h>

#include "costs/plane_manifold.h"
#include "problems/plane_step.h"
#include "tests/support/tiny_scene.h"

namespace facet {
namespace {

Eigen::Map<Eigen::Vector3d> Normal(int plane, ReconState* state) {
  return Eigen::Map<Eigen::Vector3d>(state->planes.data() + kPlaneSize * plane);
}

// The walls of the scene are orthogonal. Breaks if the axes depend on how the
// world is turned, or on the signs of normals.
TEST(Manhattan, FindsTheAxesOfATurnedRoom) {
  const TinyScene scene = MakeTinyScene();
  const Eigen::Quaterniond turn =
      Eigen::Quaterniond(0.8, 0.3, -0.4, 0.33).normalized();
  ReconState state = scene.truth;
  for (int j = 0; j < scene.problem.NumPlanes(); ++j) {
    const Eigen::Vector3d n = Normal(j, &state);
    Normal(j, &state) = turn * (j % 2 ? n : Eigen::Vector3d(-n));
  }
  const Eigen::Matrix3d axes = EstimateAxes({scene.problem, state, 1});
  EXPECT_LT((axes * axes.transpose() - Eigen::Matrix3d::Identity()).norm(),
            1e-12);
  for (int j = 0; j < scene.problem.NumPlanes(); ++j) {
    const Eigen::Vector3d n = Normal(j, &state);
    EXPECT_NEAR((axes.transpose() * n).cwiseAbs().maxCoeff(), 1, 1e-12);
  }
}

// Breaks if slanted planes are straightened, or unseen ones count.
TEST(Manhattan, LeavesSlantedAndUnseenPlanesAlone) {
  TinyScene scene = MakeTinyScene();
  ReconState state = scene.truth;
  const Term all = MakeManhattanTerm({scene.problem, state, 1}, 1);
  EXPECT_EQ(static_cast<int>(all.blocks.size()), scene.problem.NumPlanes());
  EXPECT_NEAR(EvaluateTerm(all, state), 0, 1e-9);
  int smallest = 0;
  for (int j = 0; j < scene.problem.NumPlanes(); ++j) {
    if (scene.problem.plane_texels[j] < scene.problem.plane_texels[smallest]) {
      smallest = j;
    }
  }
  const Eigen::Vector3d n = Normal(smallest, &state);
  Normal(smallest, &state) =
      Eigen::AngleAxisd(0.2, n.unitOrthogonal()) * n;  // 11 degrees
  const Term others = MakeManhattanTerm({scene.problem, state, 1}, 1);
  EXPECT_EQ(others.blocks.size() + 1, all.blocks.size());
  for (const TermBlock& block : others.blocks) EXPECT_NE(block.plane, smallest);
  scene.problem.plane_texels[smallest] = 0;
  Normal(smallest, &state) = n;
  EXPECT_EQ(MakeManhattanTerm({scene.problem, state, 1}, 1).blocks.size(),
            others.blocks.size());
}

// One degree off costs 0.05^2 a texel, of the full grid. Breaks by a wrong
// unit, or if another stride changes the weight of the term.
TEST(Manhattan, ADegreeCostsWhatItSays) {
  TinyScene scene = MakeTinyScene();
  ReconState state = scene.truth;
  const Term term = MakeManhattanTerm({scene.problem, state, 1}, 1);
  const Eigen::Vector3d n = Normal(0, &state);
  Normal(0, &state) =
      Eigen::AngleAxisd(3.14159265358979 / 180, n.unitOrthogonal()) * n;
  const double expected =
      0.05 * 0.05 * static_cast<double>(scene.problem.plane_texels[0]);
  EXPECT_NEAR(EvaluateTerm(term, state), expected, 1e-3 * expected);
  const Term of_stride_2 =
      MakeManhattanTerm({scene.problem, scene.truth, 4}, 1);
  EXPECT_NEAR(EvaluateTerm(of_stride_2, state), 4 * expected, 4e-3 * expected);
}

// Breaks if a strong term does not straighten the room.
TEST(Manhattan, StraightensPlanesWhenItIsStrong) {
  TinyScene scene = MakeTinyScene();
  ReconState state = scene.truth;
  PerturbPlanes(0.03, 0, 2, &state);
  EnergyWeights weights = StartFrom(&state, &scene.problem);
  const ReconState start = state;
  const auto solve = [&] {
    state = start;
    SolverConfig config;
    config.max_plane_iterations = 20;
    SolverMemory memory;
    PhaseSummary summary;
    SolvePlanes(scene.problem, weights, config, &memory, &state, &summary);
    return std::abs(Normal(0, &state).dot(Normal(1, &state))) +
           std::abs(Normal(1, &state).dot(Normal(2, &state)));
  };
  const double without = solve();
  AddTerms({{"manhattan", 1e6}}, start, 1, &scene.problem);
  EXPECT_LT(solve(), 0.1 * without);
}

}  // namespace
}  // namespace facet
