// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The formulations of the photometric energy and its unknowns that can be
// compared: one struct, and one table from which the programs take their help
// texts, their choices and their lists. The first value of an axis is the
// default. How the unknowns are solved for is the schedule's business
// (problems/solve_blocks.h).
#pragma once

#include <string>
#include <vector>

#include "costs/photo_kernel.h"
#include "costs/plane_manifold.h"
#include "costs/se3_manifold.h"
#include "problems/joint_method.h"

namespace facet {

// What holds the model in place (problems/gauge.h, costs/pose_prior.h).
enum class Gauge { kMean, kPrior, kFirst, kNone };

enum class Channels {
  kLuma,  // one residual an observation
  kRgb,   // three, each with weight 1/3: E_c keeps its scale
};

// How Ceres sees the residuals of the phases Phi, T and F.
enum class Evaluation {
  kCompressed,  // a small block for all that share parameters (production)
  kReference,   // an autodiff block an observation, in double
};

// Residual blocks, one an observation, that kReference and the joint methods
// with explicit colours may build: each takes about 700 bytes.
inline constexpr size_t kMaxReferenceObservations = 3000000;

// One choice on each axis but the gauge, whose parts belong to EnergyWeights
// and SolverConfig. Constant during an optimisation.
struct Formulation {
  PlaneKind plane = PlaneKind::kAnchored;
  PoseKind manifold = PoseKind::kLeft;
  Sampling sampling = Sampling::kBilinear;
  LossKind loss = LossKind::kSquared;
  double loss_scale = 0.05;  // of the robust losses [intensity]
  OutOfImage out_of_image = OutOfImage::kFreeze;
  Channels channels = Channels::kLuma;
  Evaluation evaluation = Evaluation::kCompressed;
};

struct FormulationValue {
  const char* name;
  const char* text;
};

// `values` are in the order of the axis' enum.
struct FormulationAxis {
  const char* name;  // also the flag of facet-reconstruct
  const char* text;
  std::vector<FormulationValue> values;
};

const std::vector<FormulationAxis>& FormulationAxes();

// "text: value (its text), value (...)" of the axis `name`, and the name of its
// first value: help and default of its flag. The text lives for ever.
const char* AxisHelp(const std::string& name);
const char* AxisDefault(const std::string& name);

// What a phase of a schedule solves: a BlockSet (problems/solve_blocks.h), and
// by which method if it is joint.
struct SolvedSet {
  unsigned blocks = 0;
  JointMethod joint = JointMethod::kConsensus;
};

// Throws OptionsError with the reason if the formulation cannot be solved by
// these phases.
void CheckFormulation(const Formulation& formulation,
                      const std::vector<SolvedSet>& phases);

// The same for the number of observations, known when visibility is.
void CheckObservationLimit(const Formulation& formulation,
                           const std::vector<SolvedSet>& phases,
                           size_t observations);

}  // namespace facet
