// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The values of flags that name one of several ways to do a thing. One table
// serves the parser of the flags and facet-ablate --list. The axes of the
// formulation come from problems/formulation.h: to add a value, add it to its
// enum and to the table there; other flags have their row in choices.cc.
#pragma once

#include <string>
#include <vector>

namespace facet {

struct FlagChoices {
  std::string flag;
  // In the order of the enum that the flag selects. Empty: any value of the
  // flag's type.
  std::vector<std::string> values;
  // Changes how the photometric energy is written down or minimised: an axis
  // that facet-ablate --list shows.
  bool formulation = false;
};

const std::vector<FlagChoices>& AllFlagChoices();

// The row of `flag`, null if there is none.
const FlagChoices* FindFlagChoices(const std::string& flag);

// The position of `value` among the values of `flag`. Throws OptionsError that
// lists them. The flag must have a row.
int Choose(const std::string& flag, const std::string& value);

// "a, b, c".
std::string JoinValues(const std::vector<std::string>& values);

}  // namespace facet
