// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "schedule/schedule.h"

#include <cctype>

#include "problems/solve_blocks.h"
#include "util/errors.h"

namespace facet {
namespace {

class Parser {
 public:
  explicit Parser(const std::string& text) : text_(text) {}

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
  [[noreturn]] void Fail(const std::string& expected) const {
    throw OptionsError("--schedule: expected " + expected + " at character " +
                       std::to_string(at_ + 1) + ":\n  " + text_ + "\n  " +
                       std::string(at_, ' ') +
                       "^\nA schedule looks like 10x[C; Phi; T+F]; blocks are "
                       "C (colours), Phi (planes), T (poses), F (warps)");
  }

  void SkipSpace() {
    while (at_ < text_.size() && std::isspace(
                                     static_cast<unsigned char>(text_[at_]))) {
      ++at_;
    }
  }

  bool Accept(char c) {
    SkipSpace();
    if (at_ >= text_.size() || text_[at_] != c) return false;
    ++at_;
    return true;
  }

  ScheduleGroup Group() {
    ScheduleGroup group;
    SkipSpace();
    const size_t start = at_;
    int count = 0;
    while (at_ < text_.size() &&
           std::isdigit(static_cast<unsigned char>(text_[at_]))) {
      count = 10 * count + (text_[at_++] - '0');
      if (count > 100000) Fail("a count up to 100000");
    }
    if (at_ > start) {
      if (count == 0) {
        at_ = start;
        Fail("a positive count");
      }
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
    return group;
  }

  unsigned Phase() {
    unsigned blocks = 0;
    do {
      blocks |= Block();
    } while (Accept('+'));
    return blocks;
  }

  unsigned Block() {
    SkipSpace();
    const auto starts_with = [&](const std::string& word) {
      if (text_.compare(at_, word.size(), word) != 0) return false;
      const size_t end = at_ + word.size();
      return end >= text_.size() ||
             !std::isalnum(static_cast<unsigned char>(text_[end]));
    };
    for (const unsigned bit : {kColors, kPlanes, kPoses, kWarps}) {
      const std::string name = BlockSetName(bit);
      if (!starts_with(name)) continue;
      at_ += name.size();
      return bit;
    }
    Fail("one of C, Phi, T, F");
  }

  const std::string& text_;
  size_t at_ = 0;
};

}  // namespace

Schedule ParseSchedule(const std::string& text) { return Parser(text).Parse(); }

void CheckSchedule(const Schedule& schedule) {
  for (const ScheduleGroup& group : schedule) {
    for (const unsigned blocks : group.phases) {
      switch (blocks) {
        case kColors:
        case kPlanes:
        case kPoses:
        case kWarps:
        case kPoses | kWarps:
        case kColors | kPoses:
        case kColors | kPlanes | kPoses:
          continue;
        default:
          throw OptionsError("--schedule: the blocks " + BlockSetName(blocks) +
                             " cannot be solved together; use C, Phi, T, F, "
                             "T+F, C+T or C+Phi+T");
      }
    }
  }
}

std::vector<unsigned> PhasesOf(const Schedule& schedule) {
  std::vector<unsigned> phases;
  for (const ScheduleGroup& group : schedule) {
    phases.insert(phases.end(), group.phases.begin(), group.phases.end());
  }
  return phases;
}

std::string ToString(const Schedule& schedule) {
  std::string text;
  for (const ScheduleGroup& group : schedule) {
    if (!text.empty()) text += "; ";
    const bool brackets = group.rounds != 1 || group.phases.size() != 1;
    if (brackets) text += std::to_string(group.rounds) + "x[";
    for (size_t i = 0; i < group.phases.size(); ++i) {
      if (i > 0) text += "; ";
      text += BlockSetName(group.phases[i]);
    }
    if (brackets) text += "]";
  }
  return text;
}

}  // namespace facet
