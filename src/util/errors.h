// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The errors of facet, one class a cause. Libraries throw them, only main()
// catches them (apps/init_app.h) and turns them into an exit code. The message
// is one sentence: which file or option, what is wrong, what to do about it.
#pragma once

#include <stdexcept>
#include <string>

namespace facet {

// Exit codes of every facet program, documented in docs/cli.md.
enum ExitCode {
  kExitOk = 0,
  kExitInternal = 1,   // a bug of ours, or a flag that gflags refuses
  kExitOptions = 2,    // options that make no sense
  kExitInput = 3,      // bad or missing input
  kExitUnsolvable = 4  // the input is readable but nothing can be made of it
};

// An option has an invalid value, or two options contradict each other.
class OptionsError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

// A file is missing, unreadable, malformed or inconsistent with another one.
class InputError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

// Input that can be read but not processed, e.g. a mesh that no frame sees.
class UnsolvableError : public std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace facet
