// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Runs the programs as a user does, and says how they ended. The fixture of
// tests/cli/make_scan.cmake lies in FACET_CLI_SCAN_DIR.
#pragma once

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/temp_dir.h"

namespace facet {

struct Outcome {
  int code = -1;  // exit code; 128 + signal if it was killed
  std::string out, err;
  std::string command;  // for messages
};

// Runs facet-`program` to its end; longer than `timeout_s` is a hang: killed.
Outcome RunProgram(const std::string& program,
                   const std::vector<std::string>& arguments,
                   int timeout_s = 60);

// The scan, dense.ply, small.flags and run/ that the fixture made.
std::string Fixture(const std::string& name);

// facet-reconstruct with the small settings on the fixture's scan and mesh into
// `output`; `extra` flags come last and win.
Outcome Reconstruct(const std::string& output,
                    const std::vector<std::string>& extra = {});

// Ended with `code`, and with one sentence on stderr that contains all of
// `words`: no abort, no stack trace, no second complaint.
void ExpectRefused(const Outcome& outcome,
                   int code,
                   const std::vector<std::string>& words);

// Exit code 0; on failure shows what the program said.
void ExpectSuccess(const Outcome& outcome);

// A warning that contains `words` was logged and is in report.json.
void ExpectWarning(const Outcome& outcome,
                   const std::string& run_folder,
                   const std::string& words);

// Nothing at all was written: `folder` is absent or empty.
void ExpectNothingIn(const std::string& folder);

// No temporary file is left anywhere below `folder`.
void ExpectNoPartialFile(const std::string& folder);

nlohmann::json ReadJson(const std::string& path);

// The fixture's scan as a folder of links, to damage single files.
class ScanCopy {
 public:
  ScanCopy();

  std::string path() const { return dir_.path(); }
  // "frame-000012.<rest>" in the copy.
  std::string FrameFile(int number, const std::string& rest) const;
  // Replaces a file of the copy, never the original.
  void Write(const std::string& file, const std::string& content) const;
  // The text of info.txt with the value of `key` replaced.
  void SetInfo(const std::string& key, const std::string& value) const;

  static constexpr int kNumFrames = 24;

 private:
  TempDir dir_;
};

}  // namespace facet
