// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The axes of problems/formulation.h on the tiny scene.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "problems/color_step.h"
#include "problems/formulation.h"
#include "problems/joint_pass.h"
#include "problems/solve_blocks.h"
#include "tests/support/tiny_scene.h"
#include "util/errors.h"

namespace facet {
namespace {

using ::testing::HasSubstr;

constexpr LossKind kRobust[] = {
    LossKind::kHuber, LossKind::kCauchy, LossKind::kTukey};
constexpr double kScale = 0.02;  // residuals of the start: about 0.03

struct Start {
  TinyScene scene;
  ReconState state;
  EnergyWeights weights;
};

Start MakeStart(const Formulation& formulation, double spacing_m = 0.06) {
  TinySceneOptions options;
  options.texel_spacing_m = spacing_m;
  Start start;
  start.scene = MakeTinyScene(options);
  start.scene.problem.formulation = formulation;
  FinishTextureProblem(&start.scene.problem);
  start.state = start.scene.truth;
  PerturbPoses(0.0035, 0.005, 1, &start.state);
  PerturbPlanes(0.0035, 0.003, 2, &start.state);
  start.weights = StartFrom(&start.state, &start.scene.problem);
  return start;
}

Formulation With(LossKind loss) {
  Formulation formulation;
  formulation.loss = loss;
  formulation.loss_scale = kScale;
  return formulation;
}

double Objective(const Start& start, const ReconState& state) {
  return EvaluateEnergy(start.scene.problem, start.weights, state).Objective();
}

PhaseSummary Solve(const Start& start,
                   unsigned blocks,
                   const SolverConfig& config,
                   ReconState* state) {
  SolverMemory memory;
  return SolveBlocks(start.scene.problem,
                     start.weights,
                     blocks,
                     config,
                     EvaluateEnergy(start.scene.problem, start.weights, *state),
                     &memory,
                     state);
}

double Distance(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum);
}

// Compressed in float against one autodiff block an observation in double: the
// same first step for every block set and sampling, to 1e-4. Poses are ill
// conditioned: a diagonal shift of the compression above 2e-6 would show.
TEST(Formulations, ReferenceAndCompressedTakeTheSameStep) {
  for (const Sampling sampling :
       {Sampling::kBilinear, Sampling::kScharr, Sampling::kBicubic}) {
    Formulation formulation;
    formulation.sampling = sampling;
    Start start = MakeStart(formulation);
    SolverConfig config;
    config.remove_common_motion = false;
    config.max_plane_iterations = config.max_pose_iterations = 1;
    for (const unsigned blocks : {unsigned{kPlanes},
                                  unsigned{kPoses},
                                  unsigned{kWarps},
                                  kPoses | kWarps}) {
      ReconState compressed = start.state, reference = start.state;
      start.scene.problem.formulation.evaluation = Evaluation::kCompressed;
      EXPECT_TRUE(Solve(start, blocks, config, &compressed).accepted);
      start.scene.problem.formulation.evaluation = Evaluation::kReference;
      EXPECT_TRUE(Solve(start, blocks, config, &reference).accepted);
      for (const auto member :
           {&ReconState::planes, &ReconState::poses, &ReconState::warps}) {
        const double step = Distance(start.state.*member, reference.*member);
        EXPECT_LE(Distance(compressed.*member, reference.*member), 1e-4 * step)
            << BlockSetName(blocks) << " " << static_cast<int>(sampling) << " "
            << Distance(compressed.*member, reference.*member) / step;
      }
      const double e = Objective(start, reference);
      EXPECT_NEAR(Objective(start, compressed), e, 1e-5 * e);
    }
  }
}

// Robust phases lower the robust energy, in every evaluation; both evaluations
// end near each other (Ceres bends the Hessian of its losses, ours does not).
TEST(Formulations, RobustPhasesDescend) {
  for (const LossKind loss : kRobust) {
    Start start = MakeStart(With(loss));
    SolverConfig config;
    config.remove_common_motion = false;
    for (const unsigned blocks :
         {unsigned{kPlanes}, kPoses | kWarps, kColors | kPoses}) {
      ReconState compressed = start.state;
      start.scene.problem.formulation.evaluation = Evaluation::kCompressed;
      const PhaseSummary summary = Solve(start, blocks, config, &compressed);
      EXPECT_TRUE(summary.accepted) << summary.blocks;
      EXPECT_LT(summary.after.Objective(), summary.before.Objective());
      if (blocks & kColors) continue;
      ReconState reference = start.state;
      start.scene.problem.formulation.evaluation = Evaluation::kReference;
      const PhaseSummary by_ceres = Solve(start, blocks, config, &reference);
      EXPECT_TRUE(by_ceres.accepted) << summary.blocks;
      EXPECT_NEAR(by_ceres.after.Objective(),
                  summary.after.Objective(),
                  0.05 * summary.before.Objective());
    }
  }
}

// The IRLS colours: no single colour can move and lower E_c, the step never
// raises it, and outliers weigh less than in the mean.
TEST(Formulations, RobustColoursAreStationary) {
  for (const LossKind loss : kRobust) {
    const Start start = MakeStart(With(loss), 0.12);
    EnergyWeights weights = start.weights;
    const double best =
        EvaluateEnergy(start.scene.problem, weights, start.state).e_c;
    for (size_t i = 0; i < start.state.colors.size(); i += 17) {
      for (const float h : {-2e-3f, 2e-3f}) {
        ReconState moved = start.state;
        moved.colors[i] += h;
        const double e_c =
            EvaluateEnergy(start.scene.problem, weights, moved).e_c;
        EXPECT_GE(e_c, best * (1 - 1e-7)) << i;
      }
    }
    ReconState again = start.state;
    for (float& c : again.colors) c += 0.01f;
    const double before =
        EvaluateEnergy(start.scene.problem, weights, again).e_c;
    SolveColors(start.scene.problem, &again);
    EXPECT_LE(EvaluateEnergy(start.scene.problem, weights, again).e_c, before);
  }
}

// A loss of huge scale is none, in every phase: breaks if a scale is in other
// units somewhere.
TEST(Formulations, HugeScaleIsTheSquaredLoss) {
  Formulation huge = With(LossKind::kCauchy);
  huge.loss_scale = 1e3;
  const Start squared = MakeStart({}), robust = MakeStart(huge);
  EXPECT_NEAR(Objective(robust, robust.state),
              Objective(squared, squared.state),
              1e-4 * Objective(squared, squared.state));
  SolverConfig config;
  config.remove_common_motion = false;
  config.max_pose_iterations = config.max_plane_iterations = 2;
  for (const unsigned blocks : {unsigned{kPlanes}, unsigned{kPoses}}) {
    ReconState a = squared.state, b = robust.state;
    Solve(squared, blocks, config, &a);
    Solve(robust, blocks, config, &b);
    for (const auto member : {&ReconState::planes, &ReconState::poses}) {
      const double step = Distance(squared.state.*member, a.*member);
      EXPECT_LE(Distance(a.*member, b.*member), 1e-2 * step);
    }
  }
}

// The joint gradient with weights, robust means and dropped samples. One pose
// is far off, so that samples leave its image.
TEST(Formulations, JointGradientIsThatOfTheRobustCost) {
  for (const OutOfImage out : {OutOfImage::kFreeze, OutOfImage::kDrop}) {
    for (const LossKind loss : {LossKind::kSquared, LossKind::kHuber}) {
      Formulation formulation = With(loss);
      formulation.out_of_image = out;
      formulation.sampling = Sampling::kBicubic;
      Start start = MakeStart(formulation, 0.04);
      const TextureProblem& problem = start.scene.problem;
      const JointPass pass = RunJointPass(problem, start.state, true, 0.1);
      Eigen::VectorXd analytic(6 * problem.NumKeyframes());
      Eigen::VectorXd numeric(analytic.size());
      const double h = 5e-5;
      for (int k = 0; k < problem.NumKeyframes(); ++k) {
        for (int i = 0; i < 6; ++i) {
          double value[2];
          for (const int side : {0, 1}) {
            ReconState moved = start.state;
            Vector6d xi = Vector6d::Zero();
            xi[i] = side == 0 ? -h : h;
            LeftSe3Manifold().Plus(start.state.poses.data() + kPoseSize * k,
                                   xi.data(),
                                   moved.poses.data() + kPoseSize * k);
            value[side] = RunJointPass(problem, moved, false, 0).squares;
          }
          numeric[6 * k + i] = (value[1] - value[0]) / (2 * h);
          analytic[6 * k + i] = 2 * pass.pose_gradient[k][i];
        }
      }
      EXPECT_LT((analytic - numeric).norm(), 0.02 * numeric.norm())
          << static_cast<int>(loss) << static_cast<int>(out);
    }
  }
}

// Samples outside are counted as lost and leave E_c; with everything in view
// nothing changes.
TEST(Formulations, DroppedSamplesAreCountedAndCostNothing) {
  Formulation drop;
  drop.out_of_image = OutOfImage::kDrop;
  Start start = MakeStart(drop);
  EXPECT_EQ(
      EvaluateEnergy(start.scene.problem, start.weights, start.state).lost, 0u);
  EXPECT_NEAR(Objective(start, start.state),
              Objective(MakeStart({}), MakeStart({}).state),
              1e-6 * Objective(start, start.state));
  ReconState away = start.state;
  PerturbPoses(0.3, 0, 1, &away);
  SolveColors(start.scene.problem, &away);
  const EnergyTerms dropped =
      EvaluateEnergy(start.scene.problem, start.weights, away, true);
  EXPECT_GT(dropped.lost, 0u);
  EXPECT_EQ(dropped.lost, dropped.clamped);
  EXPECT_EQ(dropped.observations, start.scene.problem.observations.size());
  for (const float c : away.colors) EXPECT_TRUE(std::isfinite(c));
  start.scene.problem.formulation.out_of_image = OutOfImage::kFreeze;
  const EnergyTerms frozen =
      EvaluateEnergy(start.scene.problem, start.weights, away, true);
  EXPECT_LT(dropped.e_c, frozen.e_c);
  EXPECT_EQ(dropped.rms_grey, frozen.rms_grey);  // of all samples
}

// Three times the same image is one image, in every phase: breaks if a channel
// reads another one's colours or its weight is not 1/3.
TEST(Formulations, ThreeEqualChannelsAreOne) {
  const Start luma = MakeStart({});
  Formulation formulation;
  formulation.channels = Channels::kRgb;
  formulation.sampling = Sampling::kScharr;
  Start rgb = MakeStart({});
  TextureProblem& problem = rgb.scene.problem;
  problem.formulation = formulation;
  problem.more_images = {problem.images, problem.images};
  FinishTextureProblem(&problem);
  rgb.state.colors.resize(3 * problem.texels.size());
  rgb.weights = StartFrom(&rgb.state, &problem);
  problem.formulation.sampling = Sampling::kBilinear;
  SolverConfig config;
  config.remove_common_motion = false;
  config.max_pose_iterations = config.max_plane_iterations = 2;
  EXPECT_NEAR(Objective(rgb, rgb.state),
              Objective(luma, luma.state),
              1e-6 * Objective(luma, luma.state));
  for (const unsigned blocks :
       {unsigned{kPlanes}, kPoses | kWarps, kColors | kPoses}) {
    ReconState a = luma.state, b = rgb.state;
    EXPECT_TRUE(Solve(luma, blocks, config, &a).accepted);
    EXPECT_TRUE(Solve(rgb, blocks, config, &b).accepted);
    EXPECT_NEAR(
        Objective(rgb, b), Objective(luma, a), 1e-4 * Objective(luma, a))
        << BlockSetName(blocks);
  }
}

// The first value of every axis is the default of the struct, and the help
// names all values.
TEST(Formulations, FirstValuesAreTheDefaults) {
  const Formulation defaults;
  EXPECT_EQ(static_cast<int>(defaults.plane), 0);
  EXPECT_EQ(static_cast<int>(defaults.manifold), 0);
  EXPECT_EQ(static_cast<int>(defaults.sampling), 0);
  EXPECT_EQ(static_cast<int>(defaults.loss), 0);
  EXPECT_EQ(static_cast<int>(defaults.out_of_image), 0);
  EXPECT_EQ(static_cast<int>(defaults.channels), 0);
  EXPECT_EQ(static_cast<int>(defaults.evaluation), 0);
  for (const FormulationAxis& axis : FormulationAxes()) {
    EXPECT_STREQ(AxisDefault(axis.name), axis.values[0].name);
    for (const FormulationValue& value : axis.values) {
      EXPECT_THAT(AxisHelp(axis.name), HasSubstr(value.name));
    }
  }
}

// What makes no sense together is refused with the reason. Explicit colours can
// solve everything, on small problems.
TEST(Formulations, NonsenseIsRefused) {
  const SolvedSet planes{kPlanes}, poses{kPoses | kWarps}, colors{kColors};
  const unsigned all = kColors | kPlanes | kPoses;
  const SolvedSet joint{kColors | kPoses}, full{all};
  const SolvedSet plain{all, JointMethod::kSchur};
  Formulation raw;
  raw.plane = PlaneKind::kRaw4;
  EXPECT_NO_THROW(CheckFormulation(raw, {planes, joint, plain}));
  EXPECT_THROW(CheckFormulation(raw, {full}), OptionsError);
  Formulation reference;
  reference.evaluation = Evaluation::kReference;
  EXPECT_NO_THROW(CheckFormulation(reference, {colors, planes, poses, plain}));
  EXPECT_THROW(CheckFormulation(reference, {joint}), OptionsError);
  const size_t most = kMaxReferenceObservations;
  EXPECT_NO_THROW(CheckObservationLimit(reference, {planes}, most));
  EXPECT_THROW(CheckObservationLimit(reference, {planes}, most + 1),
               OptionsError);
  EXPECT_NO_THROW(CheckObservationLimit({}, {plain}, most));
  try {
    CheckObservationLimit({}, {planes, plain}, most + 1);
    FAIL();
  } catch (const OptionsError& error) {
    EXPECT_THAT(error.what(), HasSubstr("--joint=schur"));
    EXPECT_THAT(error.what(), HasSubstr(std::to_string(most + 1)));
  }
  // Of alternating phases the method does not matter.
  EXPECT_NO_THROW(CheckObservationLimit(
      {}, {{kPlanes, JointMethod::kSchur}, full}, size_t{1} << 40));
}

}  // namespace
}  // namespace facet
