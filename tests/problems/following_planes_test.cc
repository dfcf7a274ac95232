// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The joint system with its terms, and planes that follow the poses in it.
#include "problems/following_planes.h"

#include <ceres/autodiff_cost_function.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>

#include "costs/se3_manifold.h"
#include "problems/energy.h"
#include "problems/joint_terms.h"
#include "tests/support/tiny_scene.h"

namespace facet {
namespace {

constexpr double kWeight = 4;

class JointSystemTest : public testing::Test {
 protected:
  JointSystemTest() : scene_(MakeTinyScene(Options())), state_(scene_.truth) {
    AddDepthMoments(&scene_);
    PerturbPoses(0.003, 0.004, 1, &state_);
    PerturbPlanes(0.003, 0.003, 2, &state_);
    weights_ = StartFrom(&state_, &scene_.problem);
    weights_.texel_weight = kWeight;
    weights_.depth_weight = 0.03;
  }

  static TinySceneOptions Options() {
    TinySceneOptions options;
    options.tile_texels = 8;
    return options;
  }

  double PlaneWeight() const { return kWeight * weights_.lambda1; }

  // E_c with averaged colours + lambda1 E_p + E_prior + E_depth.
  double Objective(const ReconState& state) const {
    double sum =
        kWeight * RunJointPass(scene_.problem, state, false, 0).squares;
    for (int j = 0; j < scene_.problem.NumPlanes(); ++j) {
      const Eigen::Map<const Eigen::Vector4d> phi(state.planes.data() +
                                                  kPlaneSize * j);
      sum += PlaneWeight() * phi.dot(scene_.problem.moments[j] * phi);
    }
    return sum + EvaluateTerm(PosePriorTerm(scene_.problem, weights_), state) +
           EvaluateTerm(DepthTerm(scene_.problem, weights_), state);
  }

  // The system at the state, with residuals.
  void Build() {
    const TextureProblem& problem = scene_.problem;
    const JointPass pass = RunJointPass(problem, state_, true, 0.1);
    basis_ = pass.plane_axes;
    JointTerms terms(problem, weights_, true);
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

  void MovePose(int keyframe, const Vector6d& xi, ReconState* state) const {
    double* pose = state->poses.data() + kPoseSize * keyframe;
    const ReconState before = *state;
    LeftSe3Manifold().Plus(
        before.poses.data() + kPoseSize * keyframe, xi.data(), pose);
  }

  TinyScene scene_;
  ReconState state_;
  EnergyWeights weights_;
  std::vector<PlaneBasis> basis_;
  JointSystem system_;
};

// Breaks when planes follow with a wrong sign or frame, when a pose row keeps
// what the planes take over, or when an offset is over another tangent than its
// row: R^T r is then not the derivative along a pose whose planes follow.
TEST_F(JointSystemTest, RowsAreTheGradientAlongPosesThatPlanesFollow) {
  Build();
  const double h = 2e-5;
  for (const PlaneKind kind : {PlaneKind::kAnchored,
                               PlaneKind::kRaw4,
                               PlaneKind::kNormalised4,
                               PlaneKind::kOrigin,
                               PlaneKind::kUnit4}) {
    scene_.problem.formulation.plane = kind;
    ReconState moved = state_;
    FollowingPlanes planes(scene_.problem, &moved);
    planes.Follow(system_, basis_);
    std::vector<double> analytic, numeric;
    const auto difference = [&](const auto& move) {
      double value[2];
      for (const int side : {0, 1}) {
        moved = state_;
        move(side == 0 ? -h : h);
        ASSERT_TRUE(planes.Place());
        value[side] = Objective(moved);
        move(0);
      }
      numeric.push_back((value[1] - value[0]) / (2 * h));
    };
    const Eigen::VectorXd by_pose =
        system_.poses.transpose() * system_.pose_residual;
    for (int k = 0; k < scene_.problem.NumKeyframes(); ++k) {
      for (int i = 0; i < 6; ++i) {
        analytic.push_back(2 * by_pose[6 * k + i]);
        difference([&](double step) {
          moved.poses = state_.poses;
          MovePose(k, step * Vector6d::Unit(i), &moved);
        });
      }
    }
    for (int j = 0; j < scene_.problem.NumPlanes(); ++j) {
      const Eigen::VectorXd by_offset =
          (system_.planes[j].diagonal * planes.BasisFromOffset(j)).transpose() *
          system_.planes[j].residual;
      for (int i = 0; i < planes.offset_size(); ++i) {
        analytic.push_back(2 * by_offset[i]);
        difference([&](double step) { planes.offset(j)[i] = step; });
      }
    }
    const Eigen::Map<Eigen::VectorXd> a(analytic.data(), analytic.size());
    const Eigen::Map<Eigen::VectorXd> n(numeric.data(), numeric.size());
    // Bilinear kinks: about 1 % on single entries.
    EXPECT_LT((a - n).norm(), 0.02 * n.norm())
        << "analytic " << a.transpose() << "\nnumeric " << n.transpose();
  }
}

// Breaks when offsets or poses are counted from an old point: a plane would
// jump when the next linearisation begins.
TEST_F(JointSystemTest, PlanesStayWhereTheyAreWhenTheyFollowFromANewPoint) {
  Build();
  ReconState moved = state_;
  FollowingPlanes planes(scene_.problem, &moved);
  ASSERT_TRUE(planes.Place());
  EXPECT_EQ(moved.planes, state_.planes);
  planes.Follow(system_, basis_);
  for (int k = 0; k < scene_.problem.NumKeyframes(); ++k) {
    MovePose(k, 1e-3 * (k + 1) * Vector6d::Ones(), &moved);
  }
  for (int i = 0; i < planes.offset_size(); ++i) planes.offset(0)[i] = 1e-3;
  ASSERT_TRUE(planes.Place());
  const std::vector<double> there = moved.planes;
  EXPECT_NE(there, state_.planes);
  planes.Follow(system_, basis_);
  ASSERT_TRUE(planes.Place());
  for (size_t i = 0; i < there.size(); ++i) {
    EXPECT_NEAR(moved.planes[i], there[i], 1e-14);
  }
}

// Breaks when planes do not go to the minimum of the model, by which Ceres
// would have to move them after the poses: there its derivative by a plane,
// R_jj' (R_jj dphi + R_jp xi), is zero.
TEST_F(JointSystemTest, PlanesFollowToTheMinimumOfTheModel) {
  Build();
  ReconState moved = state_;
  FollowingPlanes planes(scene_.problem, &moved);
  planes.Follow(system_, basis_);
  std::vector<Vector6d> xi;
  for (int k = 0; k < scene_.problem.NumKeyframes(); ++k) {
    xi.push_back(1e-6 * Vector6d::Unit(k % 6));
    MovePose(k, xi[k], &moved);
  }
  ASSERT_TRUE(planes.Place());
  for (size_t j = 0; j < system_.planes.size(); ++j) {
    const JointPlaneRows& rows = system_.planes[j];
    const Eigen::Vector4d step = Eigen::Map<const Eigen::Vector4d>(
                                     moved.planes.data() + kPlaneSize * j) -
                                 Eigen::Map<const Eigen::Vector4d>(
                                     state_.planes.data() + kPlaneSize * j);
    Eigen::Vector3d by_poses = Eigen::Vector3d::Zero();
    for (size_t a = 0; a < rows.keyframes.size(); ++a) {
      by_poses += rows.poses.middleCols<6>(6 * a) * xi[rows.keyframes[a]];
    }
    ASSERT_GT(by_poses.norm(), 0);
    EXPECT_LT((rows.diagonal * basis_[j].transpose() * step + by_poses).norm(),
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
TEST_F(JointSystemTest, TermsMayTieAPlaneToAnyPose) {
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

}  // namespace
}  // namespace facet
