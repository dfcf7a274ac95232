// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "problems/explicit_problem.h"

#include <ceres/loss_function.h>
#include <ceres/ordered_groups.h>

#include <algorithm>
#include <cmath>

#include "costs/photometric.h"
#include "costs/plane_manifold.h"
#include "costs/plane_moment.h"
#include "costs/se3_manifold.h"
#include "costs/warp_offset.h"
#include "problems/gauge.h"
#include "problems/reference_blocks.h"
#include "problems/term.h"

namespace facet {
namespace {

// PlaneKind::kRaw4 leaves the length of normals free.
void NormalisePlanes(ReconState* state) {
  for (size_t i = 0; i < state->planes.size(); i += kPlaneSize) {
    Eigen::Map<Eigen::Vector4d> phi(state->planes.data() + i);
    phi /= phi.head<3>().norm();
  }
}

}  // namespace

ExplicitProblem::ExplicitProblem(const TextureProblem& problem,
                                 const EnergyWeights& weights,
                                 ReconState* state)
    : problem_(problem),
      state_(state),
      colors_(state->colors.begin(), state->colors.end()) {
  for (int k = 0; k < problem.NumKeyframes(); ++k) AddKeyframe(k, weights);
  AddPlanes(weights);
  TermBlocks(problem, weights).AddAll(state, &ceres_);
}

double* ExplicitProblem::PlaneBlock(int j) {
  return state_->planes.data() + kPlaneSize * j;
}

double* ExplicitProblem::PoseBlock(int k) {
  return state_->poses.data() + kPoseSize * k;
}

unsigned ExplicitProblem::Kind(const double* block) const {
  const auto in = [block](const std::vector<double>& v) {
    return block >= v.data() && block < v.data() + v.size();
  };
  if (in(colors_)) return kColors;
  if (in(state_->planes)) return kPlanes;
  return in(state_->poses) ? kPoses : kWarps;
}

void ExplicitProblem::AddObservations(int k, int channel, double weight) {
  const WarpLattice& lattice = problem_.lattice;
  double* warp =
      state_->warps.data() + 2 * static_cast<size_t>(lattice.NumVertices()) * k;
  const Pose pose = state_->CamFromWorld(k);
  const SampledImage image = SampledImageOf(problem_, channel, k);
  double* colors = colors_.data() + channel * problem_.texels.size();
  for (size_t i = problem_.observations.begin[k];
       i < problem_.observations.begin[k + 1];
       ++i) {
    const uint32_t texel = problem_.observations.texel[i];
    const int j = problem_.texels.plane[texel];
    const Eigen::Vector3d p = problem_.texels.position[texel].cast<double>();
    const Eigen::Vector2d u = problem_.camera.Project<double>(
        pose * ProjectOntoPlane(PlaneBlock(j), p, problem_.anchors[j]));
    const WarpCell c = lattice.Locate(u.x(), u.y());
    const auto vertex = [&](int a, int b) {
      return warp + 2 * lattice.VertexIndex(a, b);
    };
    ceres_.AddResidualBlock(PhotometricCost::Create(MakeReferenceCost(
                                problem_, image, c.a, c.b, texel)),
                            CreateReferenceLoss(problem_.formulation, weight),
                            PoseBlock(k),
                            PlaneBlock(j),
                            colors + texel,
                            vertex(c.a, c.b),
                            vertex(c.a + 1, c.b),
                            vertex(c.a, c.b + 1),
                            vertex(c.a + 1, c.b + 1));
  }
}

void ExplicitProblem::AddKeyframe(int k, const EnergyWeights& weights) {
  for (int channel = 0; channel < problem_.NumChannels(); ++channel) {
    AddObservations(k, channel, weights.texel_weight / problem_.NumChannels());
  }
  const int num_vertices = problem_.lattice.NumVertices();
  double* warp =
      state_->warps.data() + 2 * static_cast<size_t>(num_vertices) * k;
  for (int l = 0; l < num_vertices; ++l) {
    ceres_.AddResidualBlock(
        WarpOffsetCost::Create(),
        new ceres::ScaledLoss(nullptr, weights.lambda2, ceres::TAKE_OWNERSHIP),
        warp + 2 * l);
  }
  ceres_.AddParameterBlock(PoseBlock(k),
                           kPoseSize,
                           CreatePoseManifold(problem_.formulation.manifold));
}

void ExplicitProblem::AddPlanes(const EnergyWeights& weights) {
  for (int j = 0; j < problem_.NumPlanes(); ++j) {
    ceres_.AddResidualBlock(
        new PlaneMomentCost(problem_.moments[j],
                            weights.texel_weight * weights.lambda1),
        nullptr,
        PlaneBlock(j));
    ceres_.SetManifold(
        PlaneBlock(j),
        CreatePlaneManifold(problem_.formulation.plane, problem_.anchors[j]));
    // Without an observation its derivatives are zero.
    if (problem_.plane_texels[j] == 0) {
      ceres_.SetParameterBlockConstant(PlaneBlock(j));
    }
  }
}

double ExplicitProblem::Cost() {
  double cost = 0;
  ceres_.Evaluate({}, &cost, nullptr, nullptr, nullptr);
  return cost;
}

ceres::Solver::Summary ExplicitProblem::Solve(unsigned free,
                                              ceres::Solver::Options options) {
  std::vector<double*> blocks;
  ceres_.GetParameterBlocks(&blocks);
  for (double* block : blocks) {
    if (!(Kind(block) & free)) ceres_.SetParameterBlockConstant(block);
  }
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &ceres_, &summary);
  return summary;
}

void ExplicitProblem::Step(unsigned free,
                           ceres::LinearSolverType solver,
                           int iterations) {
  ceres::Solver::Options options;
  options.linear_solver_type = solver;
  options.sparse_linear_algebra_library_type = ceres::EIGEN_SPARSE;
  options.max_num_iterations = iterations;
  options.initial_trust_region_radius = 1e4;
  Solve(free, options);
}

ceres::ParameterBlockOrdering* ExplicitProblem::Ordering(
    bool with_others) const {
  auto* ordering = new ceres::ParameterBlockOrdering;
  std::vector<double*> blocks;
  ceres_.GetParameterBlocks(&blocks);
  for (double* block : blocks) {
    if (Kind(block) == kColors) {
      ordering->AddElementToGroup(block, 0);
    } else if (with_others) {
      ordering->AddElementToGroup(block, 1);
    }
  }
  return ordering;
}

void ExplicitProblem::StoreColors() const {
  std::copy(colors_.begin(), colors_.end(), state_->colors.begin());
}

void SolveExplicit(const TextureProblem& problem,
                   const EnergyWeights& weights,
                   unsigned blocks,
                   const SolverConfig& config,
                   SolverMemory* memory,
                   ReconState* state,
                   PhaseSummary* summary) {
  ExplicitProblem explicit_problem(problem, weights, state);
  if ((blocks & kPoses) && config.remove_common_motion) {
    AddCommonMotionCost(problem,
                        EvaluateEnergy(problem, weights, *state).e_c,
                        state,
                        explicit_problem.ceres_problem());
  }
  if (config.fix_first_pose) {
    explicit_problem.ceres_problem()->SetParameterBlockConstant(
        state->poses.data());
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_SCHUR;
  options.sparse_linear_algebra_library_type = ceres::SUITE_SPARSE;
  options.linear_solver_ordering.reset(explicit_problem.Ordering(true));
  if (config.joint_method == JointMethod::kInner) {
    options.use_inner_iterations = true;
    options.inner_iteration_ordering.reset(explicit_problem.Ordering(false));
  }
  options.max_num_iterations = config.max_joint_iterations;
  options.initial_trust_region_radius = memory->explicit_radius;
  options.function_tolerance = 1e-9;
  options.num_threads = 1;  // more would sum in another order
  const ceres::Solver::Summary solved = explicit_problem.Solve(blocks, options);
  explicit_problem.StoreColors();
  if (problem.formulation.plane == PlaneKind::kRaw4) NormalisePlanes(state);
  summary->problems = 1;
  summary->iterations = static_cast<int>(solved.iterations.size());
  summary->cost_before = 2 * solved.initial_cost;
  summary->cost_after = 2 * solved.final_cost;
  if (!solved.iterations.empty()) {
    memory->explicit_radius =
        std::clamp(solved.iterations.back().trust_region_radius, 1e-2, 1e8);
  }
}

}  // namespace facet
