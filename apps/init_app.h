// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// What every program does first and last: flags, help, logging, exit codes.
#pragma once

#include <functional>
#include <set>
#include <string>

namespace facet {

struct AppDescription {
  std::string usage;  // what it does, and the typical command line
  // Text of flags (one --name=value a line) that replace defaults: the user's
  // own, on the command line or in a --flagfile, win. Called when the flags
  // have been read once; may be empty.
  std::function<std::string()> profile_flags;
  // --help shows the flags of source files whose path contains this.
  std::string help_filter = "apps/";
};

// Parses the flags, answers --help (exit 0), starts logging, runs `body` and
// maps exceptions to the exit codes of util/errors.h with one sentence on
// stderr. Positional arguments are refused. Returns the exit code.
int RunApp(int argc,
           char** argv,
           const AppDescription& description,
           const std::function<int()>& body);

// The flags of facet's own sources with their values, one --name=value a line,
// as --flagfile reads them; those named in `without` are left out.
std::string FlagsText(const std::set<std::string>& without = {});

}  // namespace facet
