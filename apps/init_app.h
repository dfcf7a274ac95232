// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// What every program does first and last: flags, help, logging, exit codes.
#pragma once

#include <functional>
#include <string>

namespace facet {

struct AppDescription {
  std::string usage;  // what it does, and the typical command line
  // Text of flags (one --name=value a line) read before the command line, so
  // that the user's own flags win. Called with the arguments; may be empty.
  std::function<std::string(int argc, char** argv)> profile_flags;
};

// Parses the flags, answers --help (exit 0), starts logging, runs `body` and
// maps exceptions to the exit codes of util/errors.h with one sentence on
// stderr. Positional arguments are refused. Returns the exit code.
int RunApp(int argc,
           char** argv,
           const AppDescription& description,
           const std::function<int()>& body);

// The value of --`name` in the raw arguments, before gflags parses them
// ("" if absent); for profiles.
std::string RawFlagValue(int argc, char** argv, const std::string& name);

}  // namespace facet
