// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// How a set that contains the colours and other blocks is solved.
#pragma once

#include <string>
#include <vector>

namespace facet {

// The first four eliminate the colours (variable projection: exact cost and
// gradient) and differ in the Hessian (problems/joint_pass.h); the last two
// keep them (problems/explicit_problem.h).
enum class JointMethod {
  kConsensus,     // of the mean texture of the views (default)
  kFrameTensors,  // of the views' own textures: D1 of docs/design.md
  kExact,         // exact Gauss-Newton Hessian of the projected cost
  kFrozen,        // as if the colours stood still
  kSchur,         // colours as e-blocks, a residual an observation: the oracle
  kInner,         // the same with Ceres's inner iterations
};

const std::vector<JointMethod>& AllJointMethods();

// "consensus", "frame_tensors", "exact", "frozen", "schur", "inner".
std::string JointMethodName(JointMethod method);
std::string JointMethodNames();  // "consensus, frame_tensors, ..."

// Colours are parameters of the Ceres problem: kSchur and kInner.
bool HasExplicitColors(JointMethod method);

// Of a joint solve without explicit colours.
enum class JointLinearSolver { kCholesky, kCgnr };

}  // namespace facet
