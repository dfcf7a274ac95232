// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "problems/formulation.h"

#include <glog/logging.h>

#include "problems/solve_blocks.h"
#include "util/errors.h"

namespace facet {
namespace {

const FormulationAxis& FindAxis(const std::string& name) {
  for (const FormulationAxis& axis : FormulationAxes()) {
    if (name == axis.name) return axis;
  }
  LOG(FATAL) << "no axis " << name;
}

bool IsJoint(unsigned blocks) {
  return (blocks & kColors) && blocks != kColors;
}

}  // namespace

const std::vector<FormulationAxis>& FormulationAxes() {
  static const auto* const axes = new std::vector<FormulationAxis>{
      {"plane",
       "plane parameters",
       {{"anchored", "S2 x R about the centroid"},
        {"raw4", "four free numbers, normalised after a solve; the paper"},
        {"normalised4", "four free numbers, normalised at every step"},
        {"origin", "S2 x R about the world's origin"},
        {"unit4", "a unit 4-vector"}}},
      {"manifold",
       "increments of a pose",
       {{"left", "T <- Exp(xi) T; the paper"},
        {"right", "T <- T Exp(xi)"},
        {"quaternion", "rotation and translation apart"}}},
      {"sampling",
       "intensities between pixels",
       {{"bilinear", "with its own derivative"},
        {"scharr", "bilinear, with the gradient of Scharr / 32 images"},
        {"bicubic", "Catmull-Rom, with its own derivative"}}},
      {"loss",
       "rho of a residual, of scale loss_scale",
       {{"squared", "r^2; the paper"},
        {"huber", "linear beyond the scale"},
        {"cauchy", "logarithmic"},
        {"tukey", "constant beyond the scale"}}},
      {"out_of_image",
       "samples that leave their image",
       {{"freeze", "read its border and count"}, {"drop", "have no residual"}}},
      {"channels",
       "residuals of an observation",
       {{"luma", "one"}, {"rgb", "three, of weight 1/3 each"}}},
      {"evaluation",
       "how Ceres gets the residuals of the phases Phi, T and F",
       {{"compressed", "one small block for all with the same parameters"},
        {"reference", "an autodiff block an observation, in double; slow"}}},
      {"gauge",
       "what holds the model in place",
       {{"mean",
         "the cameras' common motion is taken out, and a weak prior on every "
         "pose"},
        {"prior", "only the prior"},
        {"first", "the first keyframe does not move"},
        {"none", "nothing; the paper"}}},
  };
  return *axes;
}

const char* AxisHelp(const std::string& name) {
  const FormulationAxis& axis = FindAxis(name);
  auto* const text = new std::string(std::string(axis.text) + ": ");
  std::string& help = *text;
  for (size_t i = 0; i < axis.values.size(); ++i) {
    if (i > 0) help += i + 1 < axis.values.size() ? ", " : " or ";
    help += std::string(axis.values[i].name) + " (" + axis.values[i].text + ")";
  }
  return help.c_str();
}

const char* AxisDefault(const std::string& name) {
  return FindAxis(name).values.front().name;
}

void CheckFormulation(const Formulation& formulation,
                      const std::vector<SolvedSet>& phases) {
  for (const SolvedSet& phase : phases) {
    if (!IsJoint(phase.blocks) || HasExplicitColors(phase.joint)) continue;
    const std::string name = BlockSetName(phase.blocks);
    if ((phase.blocks & kPlanes) && formulation.plane == PlaneKind::kRaw4) {
      throw OptionsError(
          "--plane=raw4 cannot be solved in the phase " + name +
          ": its Hessian knows normalised planes only; use another --plane, a "
          "schedule with phases Phi, or --joint=schur");
    }
    if (formulation.evaluation == Evaluation::kReference) {
      throw OptionsError(
          "--evaluation=reference cannot be solved in the phase " + name +
          ": its joint method has no residual blocks; use --joint=schur, or a "
          "schedule of separate phases, as 10x[C; Phi; T+F]");
    }
  }
}

void CheckObservationLimit(const Formulation& formulation,
                           const std::vector<SolvedSet>& phases,
                           size_t observations) {
  if (observations <= kMaxReferenceObservations) return;
  std::string what, instead;
  for (const SolvedSet& phase : phases) {
    if (!IsJoint(phase.blocks) || !HasExplicitColors(phase.joint)) continue;
    what = "--joint=" + JointMethodName(phase.joint);
    instead = "--joint=consensus";
  }
  if (formulation.evaluation == Evaluation::kReference) {
    what = "--evaluation=reference";
    instead = "--evaluation=compressed";
  }
  if (what.empty()) return;
  throw OptionsError(
      what + " builds a residual block for each of the " +
      std::to_string(observations) + " observations, and is limited to " +
      std::to_string(kMaxReferenceObservations) +
      "; raise --texel_stride, lower --max_observations or use " + instead);
}

}  // namespace facet
