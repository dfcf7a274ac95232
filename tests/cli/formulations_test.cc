// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Every value of every axis of the formulation, one switch away from the
// default, through the whole program.
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "problems/formulation.h"
#include "tests/cli/cli_run.h"
#include "util/errors.h"

namespace facet {
namespace {

using Switch = std::pair<std::string, std::string>;

std::vector<Switch> AllSwitches() {
  std::vector<Switch> switches;
  for (const FormulationAxis& axis : FormulationAxes()) {
    for (size_t i = 1; i < axis.values.size(); ++i) {
      switches.emplace_back(axis.name, axis.values[i].name);
    }
  }
  return switches;
}

class CliFormulation : public testing::TestWithParam<Switch> {};

// Runs to the end with the phases of the default schedule (the reference has no
// joint phase), lowers its energy and records what it was.
TEST_P(CliFormulation, RunsOneSwitchAwayFromTheDefault) {
  const auto& [axis, value] = GetParam();
  const TempDir dir;
  const std::string schedule = value == "reference"
                                   ? "--schedule=1x[C; Phi; T; F]"
                                   : "--schedule=1x[Phi; C+T; C; Phi; F; T]";
  ExpectSuccess(Reconstruct(dir / "run",
                            {schedule,
                             "--" + axis + "=" + value,
                             "--texel_size=0.03",
                             "--to_stage=photometric"}));
  const nlohmann::json report = ReadJson(dir / "run/report.json");
  EXPECT_LT(report["energy"]["final"]["E_tex"],
            report["energy"]["initial"]["E_tex"]);
}

INSTANTIATE_TEST_SUITE_P(Values,
                         CliFormulation,
                         testing::ValuesIn(AllSwitches()),
                         [](const auto& param_info) {
                           return param_info.param.first + "_" +
                                  param_info.param.second;
                         });

TEST(CliFormulations, NonsenseIsRefusedBeforeTheWork) {
  const TempDir dir;
  ExpectRefused(
      Reconstruct(dir / "run", {"--evaluation=reference", "--schedule=C+T"}),
      kExitOptions,
      {"--evaluation=reference", "C+T"});
  ExpectRefused(
      Reconstruct(dir / "run", {"--plane=raw4", "--schedule=C+Phi+T"}),
      kExitOptions,
      {"--plane=raw4", "C+Phi+T"});
  ExpectRefused(Reconstruct(dir / "run", {"--sampling=nearest"}),
                kExitOptions,
                {"--sampling", "bilinear", "scharr", "bicubic"});
  ExpectRefused(Reconstruct(dir / "run", {"--loss_scale=0"}),
                kExitOptions,
                {"--loss_scale"});
  ExpectNothingIn(dir.path());
}

}  // namespace
}  // namespace facet
