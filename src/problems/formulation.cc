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

bool IsJoint(unsigned blocks) { return (blocks & kColors) && blocks != kColors; }

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

int AxisIndex(const std::string& name, const std::string& value) {
  const FormulationAxis& axis = FindAxis(name);
  std::string list;
  for (size_t i = 0; i < axis.values.size(); ++i) {
    if (value == axis.values[i].name) return static_cast<int>(i);
    list += (i > 0 ? ", " : "") + std::string(axis.values[i].name);
  }
  throw OptionsError("--" + name + "=" + value + " is not possible: use " +
                     list);
}

void CheckFormulation(const Formulation& formulation,
                      const std::vector<unsigned>& phases) {
  for (const unsigned blocks : phases) {
    if (IsJoint(blocks) && (blocks & kPlanes) &&
        formulation.plane == PlaneKind::kRaw4) {
      throw OptionsError(
          "--plane=raw4 cannot be solved in the phase " + BlockSetName(blocks) +
          ": its Hessian knows normalised planes only; use another --plane, or "
          "a schedule with phases Phi");
    }
  }
}

}  // namespace facet
