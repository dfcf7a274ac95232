// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "apps/flags/optimisation.h"

#include <gflags/gflags.h>

#include "apps/flags/choices.h"
#include "problems/formulation.h"
#include "terms/term_kinds.h"

using facet::EnergyWeights;
using facet::PhotometricOptions;
using facet::SolverConfig;

DEFINE_string(schedule,
              PhotometricOptions().schedule,
              "what is solved when: N x [phase; phase], a phase is a sum of C "
              "(colours), Phi (planes), T (poses), F (warps); the paper is "
              "10x[C; Phi; T+F]. Options: 4x[C+T{iterations=3, joint=exact}; "
              "T+F{decoupled}]{stop=1e-3}");
DEFINE_string(joint,
              facet::JointMethodName(SolverConfig().joint_method),
              "how colours are solved jointly with other blocks (C+T, "
              "C+Phi+T): consensus, frame_tensors, exact, frozen (colours "
              "eliminated, by Hessian); schur, inner (colours kept: the oracle "
              "on small problems)");
DEFINE_string(linear_solver,
              "cgnr",
              "of joint solves with eliminated colours: cholesky or cgnr");
DEFINE_int32(levels,
             PhotometricOptions().levels,
             "coarse-to-fine: image pyramid levels, each half as large as the "
             "next with twice its texel stride; warps only on the finest");
DEFINE_double(stop_decrease,
              PhotometricOptions().stop.relative_decrease,
              "a group of rounds ends when two rounds lower the energy by a "
              "smaller share, 0 = never");
DEFINE_double(smoothing,
              PhotometricOptions().smoothing_sigma_px,
              "Gaussian on the grey images [px]");
DEFINE_bool(exposure,
            PhotometricOptions().exposure,
            "bring the keyframes to a common exposure first: a gain and an "
            "offset a keyframe and channel");
DEFINE_int32(warp_columns,
             PhotometricOptions().warp_columns,
             "control vertices of the image warp across (paper: 20)");
DEFINE_int32(warp_rows,
             PhotometricOptions().warp_rows,
             "control vertices of the image warp down (paper: 16)");
DEFINE_double(lambda1_share,
              EnergyWeights().lambda1_share,
              "weight of E_p as a share of the paper's E_c / E_p at the start");
DEFINE_double(lambda2,
              EnergyWeights().lambda2,
              "weight of the warp's size E_s (paper: 0.1)");
DEFINE_string(terms, "none", facet::TermsHelp());
DEFINE_string(gauge, facet::AxisDefault("gauge"), facet::AxisHelp("gauge"));
DEFINE_double(gauge_sigma_mm, 10, "prior: standard deviation of a camera [mm]");
DEFINE_double(gauge_sigma_deg, 0.3, "prior: standard deviation of a rotation");
DEFINE_double(
    gauge_strength,
    EnergyWeights().prior_strength,
    "prior: its energy when all cameras are one sigma away, as a share "
    "of the initial E_c");
DEFINE_string(plane, facet::AxisDefault("plane"), facet::AxisHelp("plane"));
DEFINE_string(manifold,
              facet::AxisDefault("manifold"),
              facet::AxisHelp("manifold"));
DEFINE_string(sampling,
              facet::AxisDefault("sampling"),
              facet::AxisHelp("sampling"));
DEFINE_string(loss, facet::AxisDefault("loss"), facet::AxisHelp("loss"));
DEFINE_string(out_of_image,
              facet::AxisDefault("out_of_image"),
              facet::AxisHelp("out_of_image"));
DEFINE_string(channels,
              facet::AxisDefault("channels"),
              facet::AxisHelp("channels"));
DEFINE_string(evaluation,
              facet::AxisDefault("evaluation"),
              facet::AxisHelp("evaluation"));
DEFINE_double(loss_scale,
              255 * PhotometricOptions().formulation.loss_scale,
              "robust losses: residuals beyond it count less [grey, 0-255]");
DEFINE_int32(pose_iterations,
             SolverConfig().max_pose_iterations,
             "iterations of a pose or warp solve");
DEFINE_int32(plane_iterations,
             SolverConfig().max_plane_iterations,
             "iterations of a plane solve");
DEFINE_int32(joint_iterations,
             SolverConfig().max_joint_iterations,
             "iterations of a joint solve, at most");
DEFINE_double(joint_tolerance,
              SolverConfig().joint_tolerance,
              "a joint solve (but schur, inner) ends after a step that changes "
              "the objective by less than this share");
DEFINE_int32(joint_hessian_every,
             SolverConfig().joint_hessian_every,
             "joint solves build the Hessian anew every so many iterations");
DEFINE_double(active_tolerance,
              SolverConfig().active_tolerance,
              "separate solves leave out planes and keyframes that no longer "
              "move: whose cost the last solve lowered by at most this share; "
              "0 = none");

namespace facet {

void OptimisationOptionsFromFlags(PhotometricOptions* options) {
  PhotometricOptions& p = *options;
  p.schedule = FLAGS_schedule;
  p.levels = FLAGS_levels;
  p.stop.relative_decrease = FLAGS_stop_decrease;
  p.smoothing_sigma_px = FLAGS_smoothing;
  p.exposure = FLAGS_exposure;
  p.warp_columns = FLAGS_warp_columns;
  p.warp_rows = FLAGS_warp_rows;
  p.weights.lambda1_share = FLAGS_lambda1_share;
  p.weights.lambda2 = FLAGS_lambda2;
  p.terms = ParseTerms(FLAGS_terms);
  const auto gauge = static_cast<Gauge>(Choose("gauge", FLAGS_gauge));
  p.solver.remove_common_motion = gauge == Gauge::kMean;
  p.weights.pose_prior = gauge == Gauge::kMean || gauge == Gauge::kPrior;
  p.solver.fix_first_pose = gauge == Gauge::kFirst;
  p.weights.prior_strength = FLAGS_gauge_strength;
  p.weights.prior.translation_m = 1e-3 * FLAGS_gauge_sigma_mm;
  p.weights.prior.rotation_rad =
      FLAGS_gauge_sigma_deg * 3.14159265358979323846 / 180;
  Formulation& f = p.formulation;
  f.plane = static_cast<PlaneKind>(Choose("plane", FLAGS_plane));
  f.manifold = static_cast<PoseKind>(Choose("manifold", FLAGS_manifold));
  f.sampling = static_cast<Sampling>(Choose("sampling", FLAGS_sampling));
  f.loss = static_cast<LossKind>(Choose("loss", FLAGS_loss));
  f.loss_scale = FLAGS_loss_scale / 255;
  f.out_of_image =
      static_cast<OutOfImage>(Choose("out_of_image", FLAGS_out_of_image));
  f.channels = static_cast<Channels>(Choose("channels", FLAGS_channels));
  f.evaluation =
      static_cast<Evaluation>(Choose("evaluation", FLAGS_evaluation));
  p.solver.joint_method = AllJointMethods()[Choose("joint", FLAGS_joint)];
  p.solver.joint_linear_solver =
      Choose("linear_solver", FLAGS_linear_solver) == 0
          ? JointLinearSolver::kCholesky
          : JointLinearSolver::kCgnr;
  p.solver.max_pose_iterations = FLAGS_pose_iterations;
  p.solver.max_plane_iterations = FLAGS_plane_iterations;
  p.solver.max_joint_iterations = FLAGS_joint_iterations;
  p.solver.joint_tolerance = FLAGS_joint_tolerance;
  p.solver.joint_hessian_every = FLAGS_joint_hessian_every;
  p.solver.active_tolerance = FLAGS_active_tolerance;
}

}  // namespace facet
