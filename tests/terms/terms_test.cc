// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// What must hold for every term of terms/term_kinds.cc: a new one is tested
// here without another line.
#include <gtest/gtest.h>

#include <memory>

#include "problems/color_step.h"
#include "problems/solve_blocks.h"
#include "terms/term_kinds.h"
#include "tests/support/tangent_jacobian.h"
#include "tests/support/tiny_scene.h"
#include "util/errors.h"

namespace facet {
namespace {

class Terms : public testing::TestWithParam<TermKind> {
 protected:
  Terms() : scene_(MakeTinyScene(Options())), state_(scene_.truth) {
    PerturbPoses(0.01, 0.01, 1, &state_);
    PerturbPlanes(0.03, 0.004, 2, &state_);
    weights_ = StartFrom(&state_, &scene_.problem);
    AddTerms({{GetParam().name, 100}}, state_, 1, &scene_.problem);
  }

  static TinySceneOptions Options() {
    TinySceneOptions options;
    options.texel_spacing_m = 0.1;
    return options;
  }

  const Term& term() const { return scene_.problem.terms[0]; }

  TinyScene scene_;
  ReconState state_;
  EnergyWeights weights_;
};

// Breaks by a wrong derivative, a parameter block of the wrong size, or an
// index out of range.
TEST_P(Terms, JacobiansAreTheCentralDifferences) {
  const LeftSe3Manifold pose_manifold;
  const AnchoredPlaneManifold plane_manifold;
  ASSERT_FALSE(term().blocks.empty());
  for (const TermBlock& block : term().blocks) {
    TangentBlocks blocks;
    if (block.keyframe >= 0) {
      ASSERT_LT(block.keyframe, scene_.problem.NumKeyframes());
      const double* pose = state_.poses.data() + kPoseSize * block.keyframe;
      blocks.values.emplace_back(pose, pose + kPoseSize);
      blocks.manifolds.push_back(&pose_manifold);
    }
    if (block.plane >= 0) {
      ASSERT_LT(block.plane, scene_.problem.NumPlanes());
      const double* plane = state_.planes.data() + kPlaneSize * block.plane;
      blocks.values.emplace_back(plane, plane + kPlaneSize);
      blocks.manifolds.push_back(&plane_manifold);
    }
    const auto& sizes = block.cost->parameter_block_sizes();
    ASSERT_EQ(sizes.size(), blocks.values.size());
    for (size_t b = 0; b < sizes.size(); ++b) {
      ASSERT_EQ(sizes[b], static_cast<int>(blocks.values[b].size()));
    }
    Eigen::VectorXd r;
    const Eigen::MatrixXd j = TangentJacobian(*block.cost, blocks, &r);
    EXPECT_LT((j - DifferenceJacobian(*block.cost, blocks, 1e-5)).norm(),
              1e-6 * (j.norm() + r.norm()));
  }
}

// Breaks if weights do not multiply the energy.
TEST_P(Terms, EnergyIsLinearInTheWeight) {
  const double once = EvaluateTerm(term(), state_);
  ASSERT_GT(once, 0);
  AddTerms({{GetParam().name, 300}}, state_, 1, &scene_.problem);
  EXPECT_NEAR(EvaluateTerm(term(), state_), 3 * once, 1e-9 * once);
}

// Breaks when a solver forgets the term, takes it twice, or adds the part that
// it cannot change.
TEST_P(Terms, TwiceTheCostOfEverySolverHasThem) {
  for (const JointMethod method : AllJointMethods()) {
    for (const unsigned blocks : {unsigned{kPlanes},
                                  unsigned{kPoses},
                                  kPoses | kWarps,
                                  kColors | kPoses,
                                  kColors | kPlanes | kPoses}) {
      if (!(blocks & kColors) && method != JointMethod::kConsensus) continue;
      const bool keeps_colors = (blocks & kColors) && HasExplicitColors(method);
      const auto part = [&](const ReconState& state) {
        Term there;
        for (const TermBlock& block : term().blocks) {
          const bool moves = (block.keyframe >= 0 && (blocks & kPoses)) ||
                             (block.plane >= 0 && (blocks & kPlanes));
          if (keeps_colors || moves) there.blocks.push_back(block);
        }
        return EvaluateTerm(there, state);
      };
      const auto solve = [&](bool with_term, ReconState* state) {
        TextureProblem problem = scene_.problem;
        if (!with_term) problem.terms.clear();
        SolverConfig config;
        config.joint_method = method;
        config.remove_common_motion = false;
        SolverMemory memory;
        return SolveBlocks(problem,
                           weights_,
                           blocks,
                           config,
                           EvaluateEnergy(problem, weights_, *state),
                           &memory,
                           state);
      };
      ReconState with = state_, without = state_;
      const PhaseSummary a = solve(true, &with), b = solve(false, &without);
      const std::string what = a.blocks + " " + JointMethodName(method);
      EXPECT_NEAR(
          a.cost_before - b.cost_before, part(state_), 1e-6 * b.cost_before)
          << what;
      EXPECT_TRUE(a.accepted) << what;
      EXPECT_LT(a.after.Objective(), a.before.Objective()) << what;
      EXPECT_NEAR(a.after.SumOfTerms(), EvaluateTerm(term(), with), 1e-9);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Kinds,
                         Terms,
                         testing::ValuesIn(TermKinds()),
                         [](const auto& kind) {
                           return std::string(kind.param.name);
                         });

// Breaks if nonsense is taken for a weight, or the message does not help.
TEST(ParseTerms, RefusesWhatItDoesNotKnow) {
  EXPECT_TRUE(ParseTerms("").empty());
  EXPECT_TRUE(ParseTerms(" none ").empty());
  const auto terms = ParseTerms(" manhattan : 0.5 ");
  ASSERT_EQ(terms.size(), 1u);
  EXPECT_EQ(terms[0].name, "manhattan");
  EXPECT_EQ(terms[0].weight, 0.5);
  for (const char* text : {"manhattan",
                           "manhattan:",
                           "manhattan:x",
                           "nope:1",
                           "manhattan:-1",
                           "manhattan:nan",
                           "manhattan:1e999",
                           "manhattan:1,manhattan:2",
                           "none,manhattan:1",
                           ","}) {
    try {
      ParseTerms(text);
      ADD_FAILURE() << text;
    } catch (const OptionsError& e) {
      EXPECT_NE(std::string(e.what()).find("manhattan"), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace facet
