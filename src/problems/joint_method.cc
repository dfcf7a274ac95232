// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "problems/joint_method.h"

namespace facet {

const std::vector<JointMethod>& AllJointMethods() {
  static const auto* const methods =
      new std::vector<JointMethod>{JointMethod::kConsensus,
                                   JointMethod::kFrameTensors,
                                   JointMethod::kExact,
                                   JointMethod::kFrozen,
                                   JointMethod::kSchur,
                                   JointMethod::kInner};
  return *methods;
}

std::string JointMethodName(JointMethod method) {
  switch (method) {
    case JointMethod::kConsensus:
      return "consensus";
    case JointMethod::kFrameTensors:
      return "frame_tensors";
    case JointMethod::kExact:
      return "exact";
    case JointMethod::kFrozen:
      return "frozen";
    case JointMethod::kSchur:
      return "schur";
    case JointMethod::kInner:
      return "inner";
  }
  return "";
}

std::string JointMethodNames() {
  std::string names;
  for (const JointMethod method : AllJointMethods()) {
    names += (names.empty() ? "" : ", ") + JointMethodName(method);
  }
  return names;
}

bool HasExplicitColors(JointMethod method) {
  return method == JointMethod::kSchur || method == JointMethod::kInner;
}

}  // namespace facet
