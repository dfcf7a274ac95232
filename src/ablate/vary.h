// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// What an ablation varies, as text:
//
//   vary  = axis { ";" axis } [ ";" ]
//   axis  = flag "=" value { ( "," | "|" ) value }
//   value = [ label ":" ] "{" anything "}"  |  plain
//
//   plane=anchored,raw4; schedule=10x[C; Phi; T+F] | joint:{3x[C; Phi];
//   4x[C+T]}
//
// Inside [ ], ( ) and { } the characters , | and ; are ordinary, so that a
// schedule of one group needs no quotes; a value that begins with a brace is
// quoted by it and ends with its partner; both are taken off. A label is the
// name of the value in tables and plots. The axis `flags` sets several flags at
// once:
//
//   flags=paper:{--plane=raw4 --stop_decrease=0},lean:{--pose_iterations=2}
//
// White space around flags, values and separators is free.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

namespace facet {

struct VaryValue {
  std::string label;  // the text itself unless one is given
  std::string text;
};

struct VaryAxis {
  std::string flag;  // or "flags"
  std::vector<VaryValue> values;
};

// The axis whose values are sets of flags.
inline constexpr char kFlagSetAxis[] = "flags";

// What is wrong with a name or a value, and what is possible instead, e.g.
// "expected one of anchored, raw4"; empty if it is right.
struct VaryChecks {
  std::function<std::string(const std::string& flag)> flag;
  std::function<std::string(const std::string& flag, const std::string& value)>
      value;
};

// Throws OptionsError that points at the character and says what is possible.
// `checks` may hold empty functions.
std::vector<VaryAxis> ParseVary(const std::string& text,
                                const VaryChecks& checks);

// ParseVary(ToString(axes)) gives axes back.
std::string ToString(const std::vector<VaryAxis>& axes);

// "--name=value --name=value", each value up to the next " --". Throws
// OptionsError.
std::vector<std::pair<std::string, std::string>> ParseFlagSet(
    const std::string& text);

}  // namespace facet
