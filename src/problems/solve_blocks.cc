// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "problems/solve_blocks.h"

#include "problems/color_step.h"
#include "problems/explicit_problem.h"
#include "problems/gauge.h"
#include "problems/joint_step.h"
#include "problems/plane_step.h"
#include "problems/pose_warp_step.h"
#include "util/errors.h"
#include "util/resources.h"

namespace facet {
std::string BlockSetName(unsigned blocks) {
  std::string name;
  const auto add = [&](unsigned bit, const char* text) {
    if (!(blocks & bit)) return;
    if (!name.empty()) name += "+";
    name += text;
  };
  add(kColors, "C");
  add(kPlanes, "Phi");
  add(kPoses, "T");
  add(kWarps, "F");
  return name;
}

bool CanSolve(unsigned blocks, JointMethod method) {
  if (blocks == kColors || blocks == kPlanes) return true;
  if (blocks != 0 && (blocks & ~unsigned{kPoses | kWarps}) == 0) return true;
  if (!(blocks & kColors)) return false;
  if (HasExplicitColors(method)) return true;
  return (blocks & ~unsigned{kPlanes}) == (kColors | kPoses);
}

std::string SolvableBlockSets(JointMethod method) {
  return "C, Phi, T, F, T+F, " + std::string(HasExplicitColors(method)
                                                 ? "or C with any others"
                                                 : "C+T or C+Phi+T");
}

PhaseSummary SolveBlocks(const TextureProblem& problem,
                         const EnergyWeights& weights,
                         unsigned free,
                         const SolverConfig& config,
                         const EnergyTerms& before,
                         SolverMemory* memory,
                         ReconState* state) {
  const Stopwatch watch;
  PhaseSummary summary;
  summary.blocks = BlockSetName(free);
  summary.before = before;
  if (!CanSolve(free, config.joint_method)) {
    throw OptionsError("the blocks " + summary.blocks +
                       " cannot be solved together; use " +
                       SolvableBlockSets(config.joint_method));
  }
  const ReconState backup = *state;
  if (free == kColors) {
    SolveColors(problem, state);
  } else if (free == kPlanes) {
    SolvePlanes(problem, weights, config, memory, state, &summary);
  } else if (free == (kPoses | kWarps) && config.decouple_warps) {
    for (const unsigned blocks : {kPoses, kWarps}) {
      SolvePosesAndWarps(
          problem, weights, blocks, config, memory, state, &summary);
    }
  } else if (!(free & kColors)) {
    SolvePosesAndWarps(problem, weights, free, config, memory, state, &summary);
  } else if (HasExplicitColors(config.joint_method)) {
    SolveExplicit(problem, weights, free, config, memory, state, &summary);
  } else {
    SolveJoint(problem, weights, free, config, memory, state, &summary);
  }
  const bool joint = (free & kColors) && (free & kPoses);
  if ((free & kPoses) && !joint && config.remove_common_motion) {
    RemoveCommonMotion(problem, state);
    SolveColors(problem, state);
  }
  summary.after =
      EvaluateEnergy(problem, weights, *state, config.trace_rms_grey);
  // Colours are exact up to float rounding.
  const double tolerance = free == kColors ? 1e-6 * before.Objective() : 0.0;
  if (!(summary.after.Objective() <= before.Objective() + tolerance)) {
    *state = backup;
    summary.after = before;
    summary.accepted = false;
    // Costs of a state that is no more.
    memory->plane_rest.clear();
    for (std::vector<RestMemory>& rest : memory->frame_rest) rest.clear();
  }
  summary.wall_s = watch.WallSeconds();
  summary.cpu_s = watch.CpuSecondsSince();
  return summary;
}

}  // namespace facet
