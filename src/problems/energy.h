// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The one evaluator of the paper's energy (Eq. main):
//
//   E_tex = E_c + lambda1 E_p + lambda2 E_s
//
//   E_c  sum over observations of rho((I - C)^2), intensities in 0-1, times the
//        texel weight (stride^2: as if the full texel grid took part) and 1 /
//        channels; rho(s) = s but for the robust losses (costs/robust_loss.h)
//   E_p  sum over the texels of (n.p + w)^2 [m^2], times the texel weight: all
//        texels of every plane that has an observation, seen themselves or not,
//        as in the paper. Were it the seen ones only, a plane of a thousand
//        texels of which three are seen could tilt freely. By default p runs
//        over the dense mesh instead (TextureProblem::surface).
//   E_s  sum over control vertices of |f|^2 [px^2]
//
// No 1/2: all schedules and solvers are judged by this function, never by
// Ceres's internal cost (2 * cost = E_tex + E_prior + E_depth + further terms;
// tested). The set of observations is frozen: samples outside the image are
// clamped to its border and counted (with OutOfImage::kDrop they have no
// residual and count as lost).
// Energies of different formulations do not compare; rms_grey does.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "costs/pose_prior.h"
#include "problems/texture_problem.h"

namespace facet {

struct EnergyWeights {
  double lambda1 = 0;  // set by InitialLambda1
  // Share of the paper's balance: 1 holds planes to the mesh as if all of E_c
  // at the start were noise. Where poses are far off most of it is not.
  double lambda1_share = 1;
  double lambda2 = 0.1;     // paper
  double texel_weight = 1;  // stride^2
  bool pose_prior = true;
  // E_prior when every keyframe is displaced by one sigma, as a share of the
  // initial E_c; turned into prior.scale by InitialPriorScale.
  double prior_strength = 0.0005;
  PosePriorSigmas prior;
  // Of E_d (costs/depth_moment.h): 1 weighs every depth pixel like an intensity
  // of standard deviation 0.05 (method, ch. 10); 0 = off.
  double depth_weight = 0;

  double DepthFactor() const { return depth_weight * 0.05 * 0.05; }
};

struct NamedEnergy {
  std::string name;
  double value = 0;
};

struct EnergyTerms {
  double e_c = 0, e_p = 0, e_s = 0;  // unweighted by lambda
  double e_prior = 0;                // pose prior (costs/pose_prior.h)
  double e_depth = 0;                // weighted E_d
  std::vector<NamedEnergy> e_terms;  // of TextureProblem::terms
  double e_tex = 0;                  // E_c + lambda1 E_p + lambda2 E_s
  // rms of I - C on the unsmoothed luma, 0-255, of all observations and without
  // any loss, whatever the formulation.
  double rms_grey = std::numeric_limits<double>::quiet_NaN();
  size_t observations = 0, clamped = 0, behind = 0, lost = 0;

  double SumOfTerms() const;  // e_terms
  double Objective() const { return e_tex + e_prior + e_depth + SumOfTerms(); }
  double RmsIntensity() const;  // sqrt(mean rho), smoothed images, 0-1
  double ClampedShare() const;
  double texel_weight = 1;
};

// With `with_rms_grey` also rms_grey, against colours that are the means of the
// unsmoothed images (one more pass).
EnergyTerms EvaluateEnergy(const TextureProblem& problem,
                           const EnergyWeights& weights,
                           const ReconState& state,
                           bool with_rms_grey = false);

// lambda1 = lambda1_share E_c / E_p at the initial state (paper, Sec. 3.3:
// share 1), with E_p floored at (0.5 mm)^2 a texel; 1e3 when E_c is 0 (method,
// Sec. 7.4).
double InitialLambda1(const TextureProblem& problem,
                      const EnergyWeights& weights,
                      const ReconState& initial_state);

// PosePriorSigmas::scale = sqrt(prior_strength E_c / keyframes) at the initial
// state: like lambda1 a balance of the start, so that the prior means the same
// for any number of texels and keyframes.
double InitialPriorScale(const TextureProblem& problem,
                         const EnergyWeights& weights,
                         const ReconState& initial_state);

}  // namespace facet
