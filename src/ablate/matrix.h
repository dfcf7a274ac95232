// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// From axes to the variants of an ablation.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "ablate/vary.h"

namespace facet {

enum class Design {
  kCross,       // all combinations of all values
  kOneAtATime,  // the default, and every value alone against it
};

struct Variant {
  std::string label;  // unique, e.g. "plane=raw4, schedule=paper"
  // The label of the value of each axis, in the order of the axes; "default"
  // where one_at_a_time leaves the axis alone.
  std::vector<std::string> values;
  // Flags to set, in order.
  std::vector<std::pair<std::string, std::string>> flags;
};

// The first variant is the one that all others are compared with: the first
// value of every axis (cross), or no flag at all (one_at_a_time).
//   defaults  by axis, the value that holds without the axis: with
//             one_at_a_time a value equal to it makes no variant of its own.
std::vector<Variant> ExpandMatrix(const std::vector<VaryAxis>& axes,
                                  Design design,
                                  const std::vector<std::string>& defaults);

// The values of one_at_a_time's axes that are left alone.
inline constexpr char kDefaultLabel[] = "default";

}  // namespace facet
