// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>

namespace facet {

// Without white space at either end. Views into `text`.
inline std::string_view Trim(std::string_view text) {
  constexpr const char* kBlanks = " \t\r\n\v\f";
  const size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

}  // namespace facet
