// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The joint system with its terms, in the coordinates that Ceres gets.
#include "problems/joint_coordinates.h"

#include <ceres/autodiff_cost_function.h>
#include <ceres/sized_cost_function.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "problems/color_step.h"
#include "problems/energy.h"
#include "problems/gauge.h"
#include "problems/joint_step.h"
#include "problems/joint_terms.h"
#include "tests/support/tiny_scene.h"

namespace facet {
namespace {

constexpr double kWeight = 4;
constexpr double kGauge = 1e-3;  // costs of 1 mm of common motion

class JointCoordinatesTest : public testing::Test {
 protected:
  JointCoordinatesTest()
      : scene_(MakeTinyScene(Options())), state_(scene_.truth) {
    AddDepthMoments(&scene_);
    PerturbPoses(0.003, 0.004, 1, &state_);
    PerturbPlanes(0.003, 0.003, 2, &state_);
    weights_ = StartFrom(&state_, &scene_.problem);
    PerturbPoses(
        0.001, 0.001, 3, &state_);  // off the centre of prior and gauge
    weights_.texel_weight = kWeight;
    weights_.depth_weight = 0.03;
  }

  static TinySceneOptions Options() {
    TinySceneOptions options;
    options.tile_texels = 8;
    return options;
  }

  double PlaneWeight() const { return kWeight * weights_.lambda1; }

  // E_c with averaged colours + lambda1 E_p + E_prior + E_depth + the gauge.
  double Objective(const ReconState& state) const {
    double sum =
        kWeight * RunJointPass(scene_.problem, state, false, 0).squares;
    for (int j = 0; j < scene_.problem.NumPlanes(); ++j) {
      const Eigen::Map<const Eigen::Vector4d> phi(state.planes.data() +
                                                  kPlaneSize * j);
      sum += PlaneWeight() * phi.dot(scene_.problem.moments[j] * phi);
    }
    std::vector<Pose> poses;
    for (int k = 0; k < scene_.problem.NumKeyframes(); ++k) {
      poses.push_back(state.CamFromWorld(k));
    }
    return sum + EvaluateTerm(PosePriorTerm(scene_.problem, weights_), state) +
           EvaluateTerm(DepthTerm(scene_.problem, weights_), state) +
           (CommonMotionWeight(kGauge) *
            MeanMotion(scene_.problem.initial_cam_from_world, poses))
               .squaredNorm();
  }

  // The system at the state, with residuals.
  void Build() {
    const TextureProblem& problem = scene_.problem;
    const JointPass pass = RunJointPass(problem, state_, true, 0.1);
    basis_ = pass.plane_axes;
    JointTerms terms(problem, weights_, true);
    terms.HoldCommonMotion(problem, kGauge);
    ASSERT_TRUE(terms.Evaluate(state_));
    JointHessian hessian = TensorHessian(problem, pass, basis_, kWeight, 0.99);
    terms.AddHessian(basis_, &hessian);
    system_ =
        FactorJointSystem(problem, std::move(hessian), basis_, PlaneWeight());
    JointGradient gradient =
        GradientOf(problem, pass, state_, kWeight, PlaneWeight());
    terms.AddGradient(&gradient);
    SetResiduals(gradient, basis_, &system_);
  }

  // The state after one joint solve.
  ReconState Solved() const {
    ReconState state = state_;
    SolverMemory memory;
    PhaseSummary summary;
    SolveJoint(scene_.problem,
               weights_,
               kColors | kPlanes | kPoses,
               SolverConfig(),
               &memory,
               &state,
               &summary);
    return state;
  }

  TinyScene scene_;
  ReconState state_;
  EnergyWeights weights_;
  std::vector<PlaneBasis> basis_;
  JointSystem system_;
};

// Breaks when planes follow with a wrong sign or frame, when a pose row keeps
// what the planes take over, when an offset is over another tangent than its
// row, or when a term is missing: R^T r is then not the derivative of the
// objective by the offsets.
TEST_F(JointCoordinatesTest, RowsAreTheGradientByTheOffsets) {
  Build();
  const double h = 2e-5;
  const std::pair<PlaneKind, PoseKind> kinds[] = {
      {PlaneKind::kAnchored, PoseKind::kLeft},
      {PlaneKind::kRaw4, PoseKind::kRight},
      {PlaneKind::kNormalised4, PoseKind::kQuaternion},
      {PlaneKind::kOrigin, PoseKind::kLeft},
      {PlaneKind::kUnit4, PoseKind::kRight}};
  for (const auto& [plane_kind, pose_kind] : kinds) {
    scene_.problem.formulation.plane = plane_kind;
    scene_.problem.formulation.manifold = pose_kind;
    ReconState moved = state_;
    JointCoordinates coordinates(scene_.problem, true, &moved);
    coordinates.Linearise(system_, basis_);
    std::vector<double> analytic, numeric;
    const auto compare = [&](double derivative, double* offset) {
      double value[2];
      for (const int side : {0, 1}) {
        *offset = side == 0 ? -h : h;
        ASSERT_TRUE(coordinates.Place());
        value[side] = Objective(moved);
      }
      *offset = 0;
      analytic.push_back(2 * derivative);
      numeric.push_back((value[1] - value[0]) / (2 * h));
    };
    const Eigen::VectorXd by_pose =
        system_.poses.triangularView<Eigen::Upper>().transpose() *
        system_.pose_residual;
    for (int k = 0; k < scene_.problem.NumKeyframes(); ++k) {
      const Vector6d by_offset =
          coordinates.LeftFromPose(k).transpose() * by_pose.segment<6>(6 * k);
      for (int i = 0; i < 6; ++i) {
        compare(by_offset[i], coordinates.pose(k) + i);
      }
    }
    for (int j = 0; j < scene_.problem.NumPlanes(); ++j) {
      const Eigen::VectorXd by_offset =
          (system_.planes[j].diagonal * coordinates.BasisFromPlane(j))
              .transpose() *
          system_.planes[j].residual;
      for (int i = 0; i < coordinates.plane_size(); ++i) {
        compare(by_offset[i], coordinates.plane(j) + i);
      }
    }
    const Eigen::Map<Eigen::VectorXd> a(analytic.data(), analytic.size());
    const Eigen::Map<Eigen::VectorXd> n(numeric.data(), numeric.size());
    // Bilinear kinks: about 1 % on single entries.
    EXPECT_LT((a - n).norm(), 0.02 * n.norm())
        << "analytic " << a.transpose() << "\nnumeric " << n.transpose();
  }
}

// Breaks when offsets are counted from an old point: poses and planes would
// jump when the next linearisation begins.
TEST_F(JointCoordinatesTest, NothingMovesWhenALinearisationBegins) {
  Build();
  ReconState moved = state_;
  JointCoordinates coordinates(scene_.problem, true, &moved);
  ASSERT_TRUE(coordinates.Place());
  EXPECT_EQ(moved.planes, state_.planes);
  EXPECT_EQ(moved.poses, state_.poses);
  coordinates.Linearise(system_, basis_);
  for (int k = 0; k < scene_.problem.NumKeyframes(); ++k) {
    std::fill(coordinates.pose(k), coordinates.pose(k) + 6, 1e-3 * (k + 1));
  }
  coordinates.plane(0)[0] = 1e-3;
  ASSERT_TRUE(coordinates.Place());
  const ReconState there = moved;
  EXPECT_NE(there.planes, state_.planes);
  EXPECT_NE(there.poses, state_.poses);
  coordinates.Linearise(system_, basis_);
  ASSERT_TRUE(coordinates.Place());
  for (size_t i = 0; i < there.planes.size(); ++i) {
    EXPECT_NEAR(moved.planes[i], there.planes[i], 1e-14);
  }
  for (size_t i = 0; i < there.poses.size(); ++i) {
    EXPECT_NEAR(moved.poses[i], there.poses[i], 1e-14);
  }
}

// Breaks when planes do not go to the minimum of the model, by which Ceres
// would have to move them after the poses: there its derivative by a plane,
// R_jj' (R_jj dphi + R_jp xi), is zero.
TEST_F(JointCoordinatesTest, PlanesFollowToTheMinimumOfTheModel) {
  Build();
  ReconState moved = state_;
  JointCoordinates coordinates(scene_.problem, true, &moved);
  coordinates.Linearise(system_, basis_);
  const auto xi = [](int k) -> Vector6d {
    return 1e-6 * Vector6d::Unit(k % 6);
  };
  for (int k = 0; k < scene_.problem.NumKeyframes(); ++k) {
    Eigen::Map<Vector6d>(coordinates.pose(k)) = xi(k);  // left increments
  }
  ASSERT_TRUE(coordinates.Place());
  for (size_t j = 0; j < system_.planes.size(); ++j) {
    const JointPlaneRows& rows = system_.planes[j];
    const Eigen::Map<const Eigen::Vector4d> from(state_.planes.data() +
                                                 kPlaneSize * j);
    const Eigen::Map<const Eigen::Vector4d> to(moved.planes.data() +
                                               kPlaneSize * j);
    Eigen::Vector3d by_poses = Eigen::Vector3d::Zero();
    for (size_t a = 0; a < rows.keyframes.size(); ++a) {
      by_poses += rows.poses.middleCols<6>(6 * a) * xi(rows.keyframes[a]);
    }
    ASSERT_GT(by_poses.norm(), 0);
    EXPECT_LT(
        (rows.diagonal * basis_[j].transpose() * (to - from) + by_poses).norm(),
        1e-4 * by_poses.norm());
  }
}

// r = n_x + 2 d + 3 t_z.
struct MixedCost {
  template <typename T>
  bool operator()(const T* pose, const T* plane, T* r) const {
    r[0] = plane[0] + 2.0 * plane[3] + 3.0 * pose[6];
    return true;
  }
};

// Breaks when a term between a plane and a pose that sees none of its texels is
// lost, or moves the blocks of others.
TEST_F(JointCoordinatesTest, TermsMayTieAPlaneToAnyPose) {
  const TextureProblem& problem = scene_.problem;
  const JointPass pass = RunJointPass(problem, state_, true, 0.1);
  JointHessian with = TensorHessian(problem, pass, pass.plane_axes, 1, 0.99);
  // As if the second of the keyframes that see the plane did not.
  JointPlaneBlocks& plane = with.planes[0];
  ASSERT_GE(plane.keyframes.size(), 3u);
  const int tied = plane.keyframes[1];
  const Eigen::Index columns = plane.poses.cols();
  plane.keyframes.erase(plane.keyframes.begin() + 1);
  plane.poses.middleCols(6, columns - 12) =
      plane.poses.rightCols(columns - 12).eval();
  plane.poses.conservativeResize(Eigen::NoChange, columns - 6);
  const JointHessian without = with;

  scene_.problem.terms = {
      {"mixed",
       {{std::shared_ptr<const ceres::CostFunction>(
             new ceres::AutoDiffCostFunction<MixedCost, 1, 7, 4>(
                 new MixedCost)),
         tied,
         0}}}};
  EnergyWeights none = weights_;
  none.pose_prior = false;
  none.depth_weight = 0;
  JointTerms terms(scene_.problem, none, true);
  ASSERT_TRUE(terms.Evaluate(state_));
  terms.AddHessian(pass.plane_axes, &with);
  EXPECT_NEAR(
      terms.cost(), EvaluateTerm(scene_.problem.terms[0], state_), 1e-12);

  const Eigen::RowVector3d by_plane =
      Eigen::RowVector4d(1, 0, 0, 2) * pass.plane_axes[0];
  EXPECT_TRUE(with.planes[0].plane.isApprox(
      without.planes[0].plane + by_plane.transpose() * by_plane, 1e-12));
  ASSERT_EQ(with.planes[0].keyframes.size(),
            without.planes[0].keyframes.size() + 1);
  EXPECT_TRUE(std::is_sorted(with.planes[0].keyframes.begin(),
                             with.planes[0].keyframes.end()));
  for (size_t a = 0; a < with.planes[0].keyframes.size(); ++a) {
    const auto block = with.planes[0].poses.middleCols<6>(6 * a);
    if (a == 1) {
      EXPECT_EQ(with.planes[0].keyframes[a], tied);
      // d t_z / d upsilon_z = 1.
      EXPECT_TRUE(block.col(5).isApprox(3 * by_plane.transpose(), 1e-9));
      continue;
    }
    EXPECT_EQ(block,
              without.planes[0].poses.middleCols<6>(a == 0 ? 0 : 6 * (a - 1)));
  }
}

// Fails, as a square root of what is no longer positive would.
class NoNumberAwayFromStart : public ceres::SizedCostFunction<1, 7> {
 public:
  NoNumberAwayFromStart(const double* start, bool refuses)
      : start_(start, start + 7), refuses_(refuses) {}

  bool Evaluate(double const* const* parameters,
                double* residuals,
                double** jacobians) const override {
    const bool there = std::equal(start_.begin(), start_.end(), parameters[0]);
    residuals[0] = there ? 0.0 : std::nan("");
    if (jacobians && jacobians[0]) std::fill_n(jacobians[0], 7, 0.0);
    return there || !refuses_;
  }

 private:
  std::vector<double> start_;
  bool refuses_;
};

// Breaks when a point where a term has no value counts as one, at cost 0, or
// when a solve that finds no other point does not give back its start.
TEST_F(JointCoordinatesTest, PointsWithoutAValueAreRefused) {
  for (const bool refuses : {false, true}) {
    scene_.problem.terms = {{"bad",
                             {{std::make_shared<NoNumberAwayFromStart>(
                                   state_.poses.data(), refuses),
                               0,
                               -1}}}};
    const ReconState state = Solved();
    EXPECT_EQ(state.poses, state_.poses);
    EXPECT_EQ(state.planes, state_.planes);
  }
}

// Breaks when a plane that no keyframe sees moves after a term, without E_p or
// a limit to hold it: the other solvers leave it where it is.
TEST_F(JointCoordinatesTest, PlanesThatNobodySeesStay) {
  TextureProblem& problem = scene_.problem;
  Observations kept;
  kept.begin.push_back(0);
  for (int k = 0; k < problem.NumKeyframes(); ++k) {
    for (size_t i = problem.observations.begin[k];
         i < problem.observations.begin[k + 1];
         ++i) {
      const uint32_t texel = problem.observations.texel[i];
      if (problem.texels.plane[texel] != 0) kept.texel.push_back(texel);
    }
    kept.begin.push_back(kept.texel.size());
  }
  problem.observations = kept;
  problem.tiles.clear();
  FinishTextureProblem(&problem);
  ASSERT_EQ(problem.plane_texels[0], 0u);
  SolveColors(problem, &state_);
  const ReconState state = Solved();
  EXPECT_NE(state.poses, state_.poses);
  for (int i = 0; i < kPlaneSize; ++i) {
    EXPECT_EQ(state.planes[i], state_.planes[i]);
  }
  EXPECT_NE(state.planes[kPlaneSize], state_.planes[kPlaneSize]);
}

}  // namespace
}  // namespace facet
