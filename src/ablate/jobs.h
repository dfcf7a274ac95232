// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Several programs at a time. A job is a chain of programs that run one after
// the other; jobs run side by side.
#pragma once

#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

namespace facet {

struct Finished {
  double wall_s = 0, cpu_s = 0;  // CPU: user + system, all threads
};

struct Step {
  std::function<void()> before;      // may be empty
  std::vector<std::string> command;  // program and arguments; empty = none
  std::string log_path;              // of stdout and stderr of the command
  std::function<void(const Finished&)> after;  // may be empty; only on success
};

struct Job {
  std::string name;
  std::vector<Step> steps;
  // Called with one sentence when a command ends with another code than 0; the
  // steps after it are left out.
  std::function<void(const std::string& problem)> failed;
};

// The user wants to stop (SIGINT, SIGTERM).
class Interrupted : public std::runtime_error {
 public:
  Interrupted() : std::runtime_error("interrupted") {}
};

// Runs all jobs, `slots` at a time, begun in order. SIGINT and SIGTERM kill
// what runs and throw Interrupted. What a callback throws ends everything
// likewise. Should this process be killed, the system kills its children
// (Linux).
void RunJobs(const std::vector<Job>& jobs, int slots);

}  // namespace facet
