// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The terms that --terms can add to the objective, beyond the paper's. How to
// add one of your own: docs/add-a-residual.md.
#pragma once

#include <string>
#include <vector>

#include "problems/term.h"
#include "problems/texture_problem.h"

namespace facet {

// What a term is made from, once, before the optimisation.
struct TermInput {
  const TextureProblem& problem;
  const ReconState& start;  // the state at the start
  double texel_weight;      // EnergyWeights::texel_weight: 1 on the full grid
};

struct TermKind {
  const char* name;
  const char* text;  // for --help
  // Its blocks, weighted; the name is set by AddTerms.
  Term (*make)(const TermInput& input, double weight);
};

// All of them.
const std::vector<TermKind>& TermKinds();

// Help text of --terms; lives for ever.
const char* TermsHelp();

struct WeightedTerm {
  std::string name;
  double weight = 0;  // >= 0
};

// "name:weight, name:weight"; empty or "none" = no terms. Throws OptionsError
// that says what is possible.
std::vector<WeightedTerm> ParseTerms(const std::string& text);

// Sets problem->terms. `problem` must be finished.
void AddTerms(const std::vector<WeightedTerm>& terms,
              const ReconState& start,
              double texel_weight,
              TextureProblem* problem);

}  // namespace facet
