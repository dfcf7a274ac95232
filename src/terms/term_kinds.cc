// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "terms/term_kinds.h"

#include <cmath>
#include <cstdlib>
#include <sstream>

#include "terms/manhattan.h"
#include "util/errors.h"
#include "util/text.h"

namespace facet {
namespace {

const TermKind* FindTermKind(const std::string& name) {
  for (const TermKind& kind : TermKinds()) {
    if (name == kind.name) return &kind;
  }
  return nullptr;
}

[[noreturn]] void Refuse(const std::string& item, const std::string& reason) {
  std::string known;
  for (const TermKind& kind : TermKinds()) {
    known += (known.empty() ? "" : ", ") + std::string(kind.name);
  }
  throw OptionsError("--terms: '" + item + "' " + reason +
                     "; write name:weight with one of " + known + ", or none");
}

}  // namespace

const std::vector<TermKind>& TermKinds() {
  static const auto* const kKinds = new std::vector<TermKind>{
      {"manhattan",
       "planes within 5 degrees of the room's three directions are drawn to "
       "them",
       MakeManhattanTerm},
  };
  return *kKinds;
}

const char* TermsHelp() {
  static const auto* const kText = new std::string([] {
    std::string text = "further terms of the objective, name:weight, ...:";
    for (const TermKind& kind : TermKinds()) {
      text += std::string(" ") + kind.name + " (" + kind.text + ");";
    }
    return text + " or none";
  }());
  return kText->c_str();
}

std::vector<WeightedTerm> ParseTerms(const std::string& text) {
  std::vector<WeightedTerm> terms;
  if (Trim(text) == "none") return terms;
  std::stringstream items(text);
  for (std::string item; std::getline(items, item, ',');) {
    item = std::string(Trim(item));
    const size_t colon = item.find(':');
    if (colon == std::string::npos) Refuse(item, "has no weight");
    WeightedTerm term;
    term.name = std::string(Trim(item.substr(0, colon)));
    const std::string number(Trim(item.substr(colon + 1)));
    char* end = nullptr;
    term.weight = std::strtod(number.c_str(), &end);
    if (number.empty() || *end != '\0' || !std::isfinite(term.weight) ||
        term.weight < 0) {
      Refuse(item, "has no weight of at least 0");
    }
    if (!FindTermKind(term.name)) Refuse(item, "is not known");
    for (const WeightedTerm& other : terms) {
      if (other.name == term.name) Refuse(item, "is there twice");
    }
    terms.push_back(term);
  }
  return terms;
}

void AddTerms(const std::vector<WeightedTerm>& terms,
              const ReconState& start,
              double texel_weight,
              TextureProblem* problem) {
  problem->terms.clear();
  for (const WeightedTerm& wanted : terms) {
    const TermInput input = {*problem, start, texel_weight};
    Term term = FindTermKind(wanted.name)->make(input, wanted.weight);
    term.name = wanted.name;
    problem->terms.push_back(std::move(term));
  }
}

}  // namespace facet
