// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "apps/flags/choices.h"

#include <glog/logging.h>

#include "problems/formulation.h"
#include "problems/joint_method.h"
#include "util/errors.h"

namespace facet {

namespace {

std::vector<FlagChoices> MakeTable() {
  std::vector<FlagChoices> table = {{"schedule", {}, true}};
  for (const FormulationAxis& axis : FormulationAxes()) {
    FlagChoices row = {axis.name, {}, true};
    for (const FormulationValue& value : axis.values)
      row.values.push_back(value.name);
    table.push_back(row);
  }
  FlagChoices joint = {"joint", {}, true};
  for (const JointMethod method : AllJointMethods()) {
    joint.values.push_back(JointMethodName(method));
  }
  table.push_back(joint);
  const std::vector<FlagChoices> others = {
      {"loss_scale", {}, true},
      {"linear_solver", {"cholesky", "cgnr"}, true},
      {"levels", {}, true},
      {"gauge_strength", {}, true},
      {"lambda1_share", {}, true},
      {"lambda2", {}, true},
      {"terms", {}, true},
      {"smoothing", {}, true},
      {"warp_columns", {}, true},
      {"warp_rows", {}, true},
      {"pose_iterations", {}, true},
      {"plane_iterations", {}, true},
      {"joint_iterations", {}, true},
      {"joint_tolerance", {}, true},
      {"joint_hessian_every", {}, true},
      {"active_tolerance", {}, true},
      {"stop_decrease", {}, true},
      {"profile", {"default", "paper"}},
      {"simplify_stop", {"budget", "counts"}},
      {"plane_init", {"dense", "simplified"}},
      {"geometry_freedom", {"band", "none"}},
      {"bake_sampler", {"bilinear", "bicubic"}},
  };
  table.insert(table.end(), others.begin(), others.end());
  return table;
}

}  // namespace

const std::vector<FlagChoices>& AllFlagChoices() {
  static const auto* const kTable = new std::vector<FlagChoices>(MakeTable());
  return *kTable;
}

const FlagChoices* FindFlagChoices(const std::string& flag) {
  for (const FlagChoices& row : AllFlagChoices()) {
    if (row.flag == flag) return &row;
  }
  return nullptr;
}

int Choose(const std::string& flag, const std::string& value) {
  const FlagChoices* row = FindFlagChoices(flag);
  CHECK(row != nullptr) << "no row for --" << flag << " in choices.cc";
  for (size_t i = 0; i < row->values.size(); ++i) {
    if (value == row->values[i]) return static_cast<int>(i);
  }
  throw OptionsError("--" + flag + "=" + value + " is not possible: use " +
                     JoinValues(row->values));
}

std::string JoinValues(const std::vector<std::string>& values) {
  std::string text;
  for (const std::string& value : values) {
    text += (text.empty() ? "" : ", ") + value;
  }
  return text;
}

}  // namespace facet
