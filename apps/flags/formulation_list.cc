// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "apps/flags/formulation_list.h"

#include <gflags/gflags.h>

#include <cstdio>
#include <cstdlib>

#include "apps/flags/choices.h"

namespace facet {

std::string FormulationList() {
  std::string text =
      "Formulations (the value in brackets holds without a flag); any other "
      "setting of\nthe stages photometric, geometry and export can be varied "
      "too.\n\n";
  for (const FlagChoices& row : AllFlagChoices()) {
    if (!row.formulation) continue;
    const gflags::CommandLineFlagInfo info =
        gflags::GetCommandLineFlagInfoOrDie(row.flag.c_str());
    text += row.flag + " =";
    for (const std::string& value : row.values) {
      text += value == info.current_value ? " [" + value + "]" : " " + value;
    }
    if (row.values.empty()) {
      char number[40];
      std::snprintf(
          number, sizeof(number), "%g", std::atof(info.current_value.c_str()));
      text += " " + info.type + " [" +
              (info.type == "double" ? number : info.current_value) + "]";
    }
    text += "\n    " + info.description + "\n";
  }
  return text;
}

}  // namespace facet
