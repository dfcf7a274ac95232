// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "ablate/matrix.h"

#include "util/errors.h"

namespace facet {
namespace {

void SetFlags(const VaryAxis& axis, const VaryValue& value, Variant* variant) {
  if (axis.flag != kFlagSetAxis) {
    variant->flags.emplace_back(axis.flag, value.text);
    return;
  }
  for (const auto& flag : ParseFlagSet(value.text)) {
    variant->flags.push_back(flag);
  }
}

std::string ValueLabel(const VaryAxis& axis, const VaryValue& value) {
  return value.label == value.text ? axis.flag + "=" + value.text : value.label;
}

std::vector<Variant> Cross(const std::vector<VaryAxis>& axes) {
  std::vector<Variant> variants(1);
  for (const VaryAxis& axis : axes) {
    std::vector<Variant> longer;
    for (const Variant& shorter : variants) {
      for (const VaryValue& value : axis.values) {
        Variant variant = shorter;
        if (!variant.label.empty()) variant.label += ", ";
        variant.label += ValueLabel(axis, value);
        variant.values.push_back(value.label);
        SetFlags(axis, value, &variant);
        longer.push_back(variant);
      }
    }
    variants = std::move(longer);
  }
  return variants;
}

std::vector<Variant> OneAtATime(const std::vector<VaryAxis>& axes,
                                const std::vector<std::string>& defaults) {
  const Variant plain = {
      kDefaultLabel, std::vector<std::string>(axes.size(), kDefaultLabel), {}};
  std::vector<Variant> variants = {plain};
  for (size_t a = 0; a < axes.size(); ++a) {
    for (const VaryValue& value : axes[a].values) {
      if (value.text == defaults[a]) continue;
      Variant variant = plain;
      variant.label = ValueLabel(axes[a], value);
      variant.values[a] = value.label;
      SetFlags(axes[a], value, &variant);
      variants.push_back(variant);
    }
  }
  return variants;
}

}  // namespace

std::vector<Variant> ExpandMatrix(const std::vector<VaryAxis>& axes,
                                  Design design,
                                  const std::vector<std::string>& defaults) {
  std::vector<Variant> variants =
      design == Design::kCross ? Cross(axes) : OneAtATime(axes, defaults);
  for (size_t i = 0; i < variants.size(); ++i) {
    for (size_t j = 0; j < i; ++j) {
      if (variants[i].label != variants[j].label) continue;
      throw OptionsError("--vary: two variants are called '" +
                         variants[i].label + "': give other labels");
    }
  }
  return variants;
}

}  // namespace facet
