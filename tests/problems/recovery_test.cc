// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The optimiser against ground truth, and over many phases.
#include <gtest/gtest.h>

#include <cstring>

#include "problems/solve_blocks.h"
#include "tests/support/tiny_scene.h"
#include "util/parallel_for.h"

namespace facet {
namespace {

constexpr unsigned kAlternation[] = {kColors, kPlanes, kPoses};

TinyScene PerturbedScene(ReconState* state, EnergyWeights* weights) {
  TinyScene scene = MakeTinyScene();
  *state = scene.truth;
  PerturbPoses(0.0035, 0.005, 1, state);
  PerturbPlanes(0.0035, 0.003, 2, state);
  *weights = StartFrom(state, &scene.problem);
  return scene;
}

// Cameras off by 0.2 degrees and 5 mm, planes by 0.2 degrees and 3 mm. Breaks
// if a step goes the wrong way or is far too short. The alternation is slow in
// what all cameras share (frozen colours hold it), hence the rounds.
TEST(Recovery, AlternationFindsPosesAndPlanes) {
  ReconState state;
  EnergyWeights weights;
  const TinyScene scene = PerturbedScene(&state, &weights);
  // The prior is centred at the wrong poses, and on so small a scene it weighs
  // as much as the texture; three walls hold the gauge without it.
  weights.pose_prior = false;
  const StateError start = CompareToTruth(scene, state);
  SolverConfig config;
  config.remove_common_motion = false;
  config.trace_rms_grey = false;
  SolverMemory memory;
  EnergyTerms energy = EvaluateEnergy(scene.problem, weights, state);
  const double first = energy.Objective();
  for (int round = 0; round < 60; ++round) {
    for (const unsigned blocks : kAlternation) {
      energy =
          SolveBlocks(
              scene.problem, weights, blocks, config, energy, &memory, &state)
              .after;
    }
  }
  const StateError end = CompareToTruth(scene, state);
  EXPECT_LT(energy.Objective(), 0.6 * first);
  EXPECT_LT(end.rotation_rad, start.rotation_rad / 4);
  EXPECT_LT(end.center_m, start.center_m / 4);
  EXPECT_LT(end.normal_rad, start.normal_rad / 4);
  EXPECT_LT(end.offset_m, start.offset_m / 4);
}

// From the truth there is nothing to gain: breaks if the interpolation, a
// half-pixel shift or a wrong frame pulls the cameras away.
TEST(Recovery, StaysAtTheTruth) {
  TinySceneOptions options;
  options.relief_m = 0;
  TinyScene scene = MakeTinyScene(options);
  ReconState state = scene.truth;
  const EnergyWeights weights = StartFrom(&state, &scene.problem);
  SolverMemory memory;
  EnergyTerms energy = EvaluateEnergy(scene.problem, weights, state);
  for (int round = 0; round < 5; ++round) {
    for (const unsigned blocks : kAlternation) {
      energy = SolveBlocks(
                   scene.problem, weights, blocks, {}, energy, &memory, &state)
                   .after;
    }
  }
  const StateError end = CompareToTruth(scene, state);
  EXPECT_LT(end.rotation_rad, 1e-4);
  EXPECT_LT(end.center_m, 2e-4);
  EXPECT_LT(end.normal_rad, 1e-4);
  EXPECT_LT(end.offset_m, 2e-4);
}

// Whatever the order of the phases, the objective never rises (the colours'
// float rounding apart), and the summary tells the energy of the state.
TEST(Recovery, NoPhaseRaisesTheObjective) {
  ReconState state;
  EnergyWeights weights;
  TinyScene scene = PerturbedScene(&state, &weights);
  SolverMemory memory;
  EnergyTerms energy = EvaluateEnergy(scene.problem, weights, state);
  for (const PlaneKind plane : {PlaneKind::kAnchored, PlaneKind::kRaw4}) {
    SolverConfig config;
    config.remove_common_motion = false;
    scene.problem.formulation.plane = plane;
    for (int round = 0; round < 4; ++round) {
      for (const unsigned blocks : {unsigned{kColors},
                                    unsigned{kPlanes},
                                    unsigned{kPoses},
                                    kPoses | kWarps,
                                    unsigned{kWarps}}) {
        const PhaseSummary summary = SolveBlocks(
            scene.problem, weights, blocks, config, energy, &memory, &state);
        EXPECT_LE(summary.after.Objective(), energy.Objective() * (1 + 1e-6));
        EXPECT_EQ(summary.after.Objective(),
                  EvaluateEnergy(scene.problem, weights, state).Objective());
        EXPECT_TRUE(summary.accepted || round > 0) << summary.blocks;
        energy = summary.after;
      }
    }
  }
}

constexpr PlaneKind kPlaneKinds[] = {PlaneKind::kAnchored,
                                     PlaneKind::kRaw4,
                                     PlaneKind::kNormalised4,
                                     PlaneKind::kOrigin,
                                     PlaneKind::kUnit4};

// Whatever the parameters, the result is a plane: unit normal on its old side,
// near the minimum that the default finds.
TEST(Recovery, AllPlaneKindsFindTheSamePlanes) {
  ReconState start;
  EnergyWeights weights;
  TinyScene scene = PerturbedScene(&start, &weights);
  double anchored = 0;
  for (const PlaneKind plane : kPlaneKinds) {
    ReconState state = start;
    SolverConfig config;
    config.remove_common_motion = false;
    scene.problem.formulation.plane = plane;
    SolverMemory memory;
    EnergyTerms energy = EvaluateEnergy(scene.problem, weights, state);
    for (int i = 0; i < 6; ++i) {
      energy =
          SolveBlocks(
              scene.problem, weights, kPlanes, config, energy, &memory, &state)
              .after;
    }
    if (plane == PlaneKind::kAnchored) anchored = energy.Objective();
    EXPECT_NEAR(energy.Objective(), anchored, 0.02 * anchored);
    for (int j = 0; j < 3; ++j) {
      const Eigen::Map<const Eigen::Vector3d> n(state.planes.data() + 4 * j);
      const Eigen::Map<const Eigen::Vector3d> n0(start.planes.data() + 4 * j);
      EXPECT_NEAR(n.norm(), 1, 1e-9);
      EXPECT_GT(n.dot(n0), 0.99);
    }
  }
}

// The increments of a pose change the way, not the end. (A joint solve stops
// anywhere along its soft common motions: there only the energy agrees.)
TEST(Recovery, AllPoseManifoldsFindTheSamePoses) {
  ReconState start;
  EnergyWeights weights;
  TinyScene scene = PerturbedScene(&start, &weights);
  for (const unsigned blocks : {unsigned{kPoses}, kColors | kPoses}) {
    ReconState left;
    double objective = 0;
    for (const PoseKind kind :
         {PoseKind::kLeft, PoseKind::kRight, PoseKind::kQuaternion}) {
      ReconState state = start;
      SolverConfig config;
      config.remove_common_motion = false;
      scene.problem.formulation.manifold = kind;
      SolverMemory memory;
      EnergyTerms energy = EvaluateEnergy(scene.problem, weights, state);
      for (int i = 0; i < 6; ++i) {
        energy =
            SolveBlocks(
                scene.problem, weights, blocks, config, energy, &memory, &state)
                .after;
      }
      if (kind == PoseKind::kLeft) {
        left = state;
        objective = energy.Objective();
      }
      EXPECT_NEAR(energy.Objective(), objective, 0.02 * objective);
      if (blocks != kPoses) continue;
      for (int k = 0; k < scene.problem.NumKeyframes(); ++k) {
        const Pose apart =
            state.CamFromWorld(k) * left.CamFromWorld(k).Inverse();
        EXPECT_LT(LogSe3(apart).norm(), 2e-4) << k;
      }
    }
  }
}

// --gauge=first: breaks if a step moves the camera that holds the gauge, or no
// other one.
TEST(Recovery, FirstPoseCanBeFixed) {
  ReconState start;
  EnergyWeights weights;
  const TinyScene scene = PerturbedScene(&start, &weights);
  weights.pose_prior = false;
  SolverConfig config;
  config.remove_common_motion = false;
  config.fix_first_pose = true;
  for (const unsigned blocks :
       {unsigned{kPoses}, kPoses | kWarps, kColors | kPoses}) {
    ReconState state = start;
    SolverMemory memory;
    const PhaseSummary summary =
        SolveBlocks(scene.problem,
                    weights,
                    blocks,
                    config,
                    EvaluateEnergy(scene.problem, weights, state),
                    &memory,
                    &state);
    EXPECT_TRUE(summary.accepted);
    EXPECT_LT(summary.after.Objective(), summary.before.Objective());
    for (int k = 0; k < scene.problem.NumKeyframes(); ++k) {
      const bool same = std::equal(start.poses.begin() + kPoseSize * k,
                                   start.poses.begin() + kPoseSize * (k + 1),
                                   state.poses.begin() + kPoseSize * k);
      EXPECT_EQ(same, k == 0) << k << " " << summary.blocks;
    }
  }
}

// One image is drawn with a smooth displacement of its pixels, up to 0.8 px;
// with true poses, planes and colours the warp step must find that field where
// there are texels, and nothing in the other images.
TEST(Recovery, WarpStepFindsADisplacedImage) {
  const auto field = [](int keyframe, const Eigen::Vector2d& u) {
    if (keyframe != 2) return Eigen::Vector2d(0, 0);
    return Eigen::Vector2d(0.8 * std::sin(u.x() / 50) * std::cos(u.y() / 45),
                           0.6 * std::cos(u.x() / 60 + u.y() / 40));
  };
  TinyScene scene = MakeTinyScene();
  TinySceneOptions options;
  options.displacement = field;
  TinyScene displaced = MakeTinyScene(options);
  ReconState state = scene.truth;  // with the colours of the true images
  EnergyWeights weights;
  weights.lambda2 = 1e-4;
  SolverMemory memory;
  SolverConfig config;
  config.remove_common_motion = false;
  config.max_pose_iterations = 20;
  const PhaseSummary summary =
      SolveBlocks(displaced.problem,
                  weights,
                  kWarps,
                  config,
                  EvaluateEnergy(displaced.problem, weights, state),
                  &memory,
                  &state);
  ASSERT_TRUE(summary.accepted);
  const TextureProblem& p = displaced.problem;
  const size_t num_warp = 2 * static_cast<size_t>(p.lattice.NumVertices());
  for (const int k : {1, 2}) {
    double error = 0, injected = 0;
    size_t n = 0;
    for (size_t i = p.observations.begin[k]; i < p.observations.begin[k + 1];
         ++i, ++n) {
      const uint32_t texel = p.observations.texel[i];
      const Eigen::Vector2d u = p.camera.Project<double>(
          scene.cam_from_world[k] *
          scene.planes[p.texels.plane[texel]].Project(
              p.texels.position[texel].cast<double>()));
      const Eigen::Vector2d found =
          p.lattice.Apply(state.warps.data() + num_warp * k, u) - u;
      error += (found - field(k, u)).squaredNorm();
      injected += field(k, u).squaredNorm();
    }
    const double rms = std::sqrt(error / static_cast<double>(n));
    EXPECT_GE(std::sqrt(injected / static_cast<double>(n)), k == 2 ? 0.4 : 0);
    EXPECT_LT(rms, 0.08) << k;
  }
}

// The same bytes with one thread and with two. Breaks if a sum is taken in the
// order in which threads arrive.
TEST(Recovery, ResultsDoNotDependOnTheNumberOfThreads) {
  ReconState start;
  EnergyWeights weights;
  const TinyScene scene = PerturbedScene(&start, &weights);
  ReconState results[2];
  EnergyTerms energies[2];
  for (const int threads : {1, 2}) {
    SetNumThreads(threads);
    ReconState state = start;
    SolverMemory memory;
    EnergyTerms energy = EvaluateEnergy(scene.problem, weights, state);
    for (int round = 0; round < 2; ++round) {
      for (const unsigned blocks :
           {unsigned{kColors}, unsigned{kPlanes}, kPoses | kWarps}) {
        energy =
            SolveBlocks(
                scene.problem, weights, blocks, {}, energy, &memory, &state)
                .after;
      }
    }
    results[threads - 1] = state;
    energies[threads - 1] = energy;
  }
  SetNumThreads(0);
  const auto same = [](const auto& a, const auto& b) {
    return a.size() == b.size() &&
           std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])) == 0;
  };
  EXPECT_TRUE(same(results[0].poses, results[1].poses));
  EXPECT_TRUE(same(results[0].planes, results[1].planes));
  EXPECT_TRUE(same(results[0].warps, results[1].warps));
  EXPECT_TRUE(same(results[0].colors, results[1].colors));
  EXPECT_EQ(energies[0].Objective(), energies[1].Objective());
  EXPECT_EQ(energies[0].rms_grey, energies[1].rms_grey);
}

}  // namespace
}  // namespace facet
