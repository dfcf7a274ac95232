// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Counted warnings: things that are wrong with the input but survivable. They
// are logged once and end up in report.json under "warnings".
#pragma once

#include <string>
#include <vector>

namespace facet {

// Logs `sentence` and remembers it. Thread-safe.
void AddWarning(const std::string& sentence);

// Remembers warnings of an earlier process whose result is used again; logs
// nothing.
void RestoreWarnings(const std::vector<std::string>& sentences);

// All warnings of this process so far, in order.
std::vector<std::string> Warnings();

}  // namespace facet
