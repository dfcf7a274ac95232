// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "schedule/schedule.h"

#include <cctype>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "util/errors.h"

namespace facet {
namespace {

constexpr char kHelp[] =
    "A schedule looks like 10x[C; Phi; T+F]; blocks are C (colours), Phi "
    "(planes), T (poses), F (warps); options go in braces: a phase has "
    "{iterations=3, joint=exact, decoupled}, a group {stop=1e-3}";

class Parser {
 public:
  Parser(const std::string& text, JointMethod method)
      : text_(text), method_(method) {}

  Schedule Parse() {
    Schedule schedule;
    do {
      schedule.push_back(Group());
    } while (Accept(';'));
    SkipSpace();
    if (at_ < text_.size()) Fail("';' or the end");
    return schedule;
  }

 private:
  [[noreturn]] void FailAt(size_t where, const std::string& what) const {
    throw OptionsError("--schedule: " + what + " at character " +
                       std::to_string(where + 1) + ":\n  " + text_ + "\n  " +
                       std::string(where, ' ') + "^\n" + kHelp);
  }

  [[noreturn]] void Fail(const std::string& expected) const {
    FailAt(at_, "expected " + expected);
  }

  void SkipSpace() {
    while (at_ < text_.size() &&
           std::isspace(static_cast<unsigned char>(text_[at_]))) {
      ++at_;
    }
  }

  bool Accept(char c) {
    SkipSpace();
    if (at_ >= text_.size() || text_[at_] != c) return false;
    ++at_;
    return true;
  }

  // A whole number, or -1 where none begins.
  int Count() {
    const size_t start = at_;
    int count = 0;
    while (at_ < text_.size() &&
           std::isdigit(static_cast<unsigned char>(text_[at_]))) {
      count = 10 * count + (text_[at_++] - '0');
      if (count > 100000) Fail("a count up to 100000");
    }
    if (at_ == start) return -1;
    if (count == 0) {
      at_ = start;
      Fail("a positive count");
    }
    return count;
  }

  ScheduleGroup Group() {
    ScheduleGroup group;
    SkipSpace();
    const int count = Count();
    if (count > 0) {
      group.rounds = count;
      if (!Accept('x')) Fail("'x' after the count");
      SkipSpace();
      if (at_ >= text_.size() || text_[at_] != '[') Fail("'['");
    }
    if (!Accept('[')) {
      group.phases.push_back(Phase());
      return group;
    }
    do {
      group.phases.push_back(Phase());
    } while (Accept(';'));
    if (!Accept(']')) Fail("';' or ']'");
    if (Accept('{')) {
      do {
        Option("stop");
        group.stop = Share();
      } while (Accept(','));
      CloseOptions();
    }
    return group;
  }

  SchedulePhase Phase() {
    SkipSpace();
    const size_t start = at_;
    SchedulePhase phase;
    do {
      phase.blocks |= Block();
    } while (Accept('+'));
    if (Accept('{')) {
      do {
        PhaseOption(&phase);
      } while (Accept(','));
      CloseOptions();
    }
    const JointMethod method = phase.joint.value_or(method_);
    if (!CanSolve(phase.blocks, method)) {
      FailAt(start,
             "the blocks " + BlockSetName(phase.blocks) +
                 " cannot be solved together by the joint method " +
                 JointMethodName(method) + " (it solves " +
                 SolvableBlockSets(method) + ")");
    }
    return phase;
  }

  void PhaseOption(SchedulePhase* phase) {
    SkipSpace();
    const size_t start = at_;
    const unsigned blocks = phase->blocks;
    if (AcceptWord("iterations")) {
      if (blocks == kColors) {
        FailAt(start, "colours alone have a closed form, no iterations");
      }
      Equals();
      phase->iterations = Count();
      if (*phase->iterations < 0) Fail("a count");
    } else if (AcceptWord("joint")) {
      if (!(blocks & kColors) || blocks == kColors) {
        FailAt(start, "only a joint phase such as C+T has a method");
      }
      Equals();
      phase->joint = Method();
    } else if (AcceptWord("decoupled")) {
      if (blocks != (kPoses | kWarps))
        FailAt(start, "only T+F can be decoupled");
      phase->decoupled = true;
    } else {
      Fail("iterations=N, joint=NAME or decoupled");
    }
  }

  void Option(const std::string& name) {
    SkipSpace();
    if (!AcceptWord(name)) Fail(name + "=X");
    Equals();
  }

  void Equals() {
    if (!Accept('=')) Fail("'='");
    SkipSpace();
  }

  void CloseOptions() {
    if (!Accept('}')) Fail("',' or '}'");
  }

  JointMethod Method() {
    for (const JointMethod method : AllJointMethods()) {
      if (AcceptWord(JointMethodName(method))) return method;
    }
    Fail("one of " + JointMethodNames());
  }

  double Share() {
    const char* begin = text_.c_str() + at_;
    char* end = nullptr;
    const double value = std::strtod(begin, &end);
    if (end == begin || !(value >= 0) || !(value <= 1)) {
      Fail("a share from 0 to 1");
    }
    at_ += static_cast<size_t>(end - begin);
    return value;
  }

  bool AcceptWord(const std::string& word) {
    if (text_.compare(at_, word.size(), word) != 0) return false;
    const size_t end = at_ + word.size();
    if (end < text_.size() &&
        (std::isalnum(static_cast<unsigned char>(text_[end])) ||
         text_[end] == '_')) {
      return false;
    }
    at_ = end;
    return true;
  }

  unsigned Block() {
    SkipSpace();
    for (const unsigned bit : {kColors, kPlanes, kPoses, kWarps}) {
      if (AcceptWord(BlockSetName(bit))) return bit;
    }
    Fail("one of C, Phi, T, F");
  }

  const std::string& text_;
  JointMethod method_;
  size_t at_ = 0;
};

// Shortest text that reads back as the same number.
std::string NumberText(double x) {
  char text[32];
  for (int digits = 1; digits <= 17; ++digits) {
    std::snprintf(text, sizeof(text), "%.*g", digits, x);
    if (std::strtod(text, nullptr) == x) break;
  }
  return text;
}

}  // namespace

Schedule ParseSchedule(const std::string& text, JointMethod method) {
  return Parser(text, method).Parse();
}

std::string ToString(const SchedulePhase& phase) {
  std::string options;
  const auto add = [&](const std::string& option) {
    options += (options.empty() ? "" : ", ") + option;
  };
  if (phase.iterations) add("iterations=" + std::to_string(*phase.iterations));
  if (phase.joint) add("joint=" + JointMethodName(*phase.joint));
  if (phase.decoupled) add("decoupled");
  return BlockSetName(phase.blocks) +
         (options.empty() ? "" : "{" + options + "}");
}

std::vector<SolvedSet> PhasesOf(const Schedule& schedule, JointMethod method) {
  std::vector<SolvedSet> phases;
  for (const ScheduleGroup& group : schedule) {
    for (const SchedulePhase& phase : group.phases) {
      phases.push_back({phase.blocks, phase.joint.value_or(method)});
    }
  }
  return phases;
}

std::string ToString(const Schedule& schedule) {
  std::string text;
  for (const ScheduleGroup& group : schedule) {
    if (!text.empty()) text += "; ";
    const bool brackets =
        group.rounds != 1 || group.phases.size() != 1 || group.stop;
    if (brackets) text += std::to_string(group.rounds) + "x[";
    for (size_t i = 0; i < group.phases.size(); ++i) {
      if (i > 0) text += "; ";
      text += ToString(group.phases[i]);
    }
    if (brackets) text += "]";
    if (group.stop) text += "{stop=" + NumberText(*group.stop) + "}";
  }
  return text;
}

Schedule WithoutWarps(const Schedule& schedule) {
  Schedule result;
  for (const ScheduleGroup& group : schedule) {
    ScheduleGroup rest = group;
    rest.phases.clear();
    unsigned blocks = 0;
    for (SchedulePhase phase : group.phases) {
      phase.blocks &= ~unsigned{kWarps};
      phase.decoupled = false;
      if (phase.blocks != 0) rest.phases.push_back(phase);
      blocks |= phase.blocks;
    }
    if (blocks & kPoses) result.push_back(rest);
  }
  return result;
}

SolverConfig PhaseConfig(const SolverConfig& config,
                         const SchedulePhase& phase) {
  SolverConfig result = config;
  if (phase.iterations) {
    result.max_plane_iterations = *phase.iterations;
    result.max_pose_iterations = *phase.iterations;
    result.max_joint_iterations = *phase.iterations;
  }
  if (phase.joint) result.joint_method = *phase.joint;
  if (phase.decoupled) result.decouple_warps = true;
  return result;
}

}  // namespace facet
