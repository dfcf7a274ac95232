// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The one door to every solve: which blocks are free, from which state.
//
//   {C}       closed-form means (problems/color_step.h)
//   {Phi}     one small Ceres problem a plane, on all threads
//   {T}, {F}, {T, F}   one Ceres problem a keyframe, on all threads
//   {C, T}, {C, Phi, T}   one joint Ceres problem (problems/joint_step.h)
//   {C, ...}  any set, small problems: explicit colours, methods kSchur and
//             kInner (problems/explicit_problem.h)
//
// A phase that raises the objective E_tex + E_prior is rolled back and marked.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "problems/energy.h"
#include "problems/joint_method.h"
#include "problems/rest.h"
#include "problems/texture_problem.h"

namespace facet {

enum BlockSet : unsigned {
  kColors = 1,  // C
  kPlanes = 2,  // Phi
  kPoses = 4,   // T
  kWarps = 8,   // F
};

// "C", "Phi", "T+F", ...
std::string BlockSetName(unsigned blocks);

// Whether SolveBlocks can free these blocks together, and the list of such sets
// for messages.
bool CanSolve(unsigned blocks, JointMethod method);
std::string SolvableBlockSets(JointMethod method);

struct SolverConfig {
  // After every phase that moves poses, take their common motion since the
  // start out again and average the colours anew (problems/gauge.h).
  bool remove_common_motion = true;
  bool fix_first_pose = false;  // keyframe 0 does not move
  int max_plane_iterations = 3;
  int max_pose_iterations = 5;
  // Planes and keyframes that no longer move are left out of separate solves:
  // those whose last solve lowered their own cost by at most this share of it,
  // for some phases or until their cost changes (problems/rest.h). >= 0; 0 =
  // all are solved in every phase. Joint solves always move everything.
  double active_tolerance = 0;
  // T+F: poses first, then warps, instead of both in one problem a keyframe.
  bool decouple_warps = false;
  JointMethod joint_method = JointMethod::kConsensus;
  JointLinearSolver joint_linear_solver = JointLinearSolver::kCgnr;
  // A joint solve ends after so many iterations, or after a step that changes
  // its part of the objective by less than this share (>= 0; kSchur and kInner
  // end by Ceres's own tolerances).
  int max_joint_iterations = 10;
  double joint_tolerance = 2e-5;
  // The Hessian is built and factored anew at every so many points; the
  // gradient always is. >= 1.
  int joint_hessian_every = 3;
  // kappa and eta of problems/joint_pass.h, and the largest trust-region
  // radius, which with the pose prior holds soft gauge directions.
  double joint_common_share = 0.99;
  double joint_own_share = 0.1;
  double max_joint_radius = 1e5;
  // Limits of one solve (method, Sec. 7.5): a longer step is scaled down.
  double max_rotation_rad = 2.0 * 3.14159265358979 / 180;
  double max_translation_m = 0.03;
  double max_plane_offset_m = 0.02;
  double max_plane_tilt_rad = 3.0 * 3.14159265358979 / 180;
  double max_warp_px = 5;
  // Also rms_grey after every phase (one more pass over the observations).
  bool trace_rms_grey = true;
  // Keep poses and planes after every phase (schedule/run_schedule.h).
  bool trace_states = false;
  // Keyframes with fewer observations keep their pose.
  size_t min_frame_observations = 200;
};

// What one solve of a block hands on to the next; sized on first use. For one
// TextureProblem with its weights: start anew where these change.
struct SolverMemory {
  // Trust-region radii.
  std::vector<double> plane_radius, frame_radius;
  // The joint one starts small: its Hessian promises more than there is, steps
  // of a radius of 1e4 were refused three in five times.
  double joint_radius = 100, explicit_radius = 1e4;
  // Who may rest; of keyframes apart for {T}, {F} and {T, F}, which have
  // different costs.
  std::vector<RestMemory> plane_rest;
  std::array<std::vector<RestMemory>, 3> frame_rest;
};

struct PhaseSummary {
  std::string blocks;
  bool accepted = true;  // false: rolled back
  int problems = 0;      // Ceres problems solved
  int iterations = 0;    // summed over them
  int reverted = 0;      // problems whose result was worse and undone
  int resting = 0;       // problems left out, see active_tolerance
  // Twice Ceres's own cost at start and end, summed over the problems: the
  // terms of the objective that the phase can change (tested). Resting problems
  // add the cost that they were found with to both.
  double cost_before = 0, cost_after = 0;
  double wall_s = 0, cpu_s = 0;
  EnergyTerms before, after;
};

// Optimises the blocks of the set `free` in place. `before` = energy of *state
// (known from the previous phase).
PhaseSummary SolveBlocks(const TextureProblem& problem,
                         const EnergyWeights& weights,
                         unsigned free,
                         const SolverConfig& config,
                         const EnergyTerms& before,
                         SolverMemory* memory,
                         ReconState* state);

}  // namespace facet
