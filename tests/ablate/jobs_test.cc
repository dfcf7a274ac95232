// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "ablate/jobs.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <unistd.h>

#include <filesystem>

#include "tests/support/temp_dir.h"
#include "util/atomic_file.h"
#include "util/errors.h"

namespace facet {
namespace {

Step Shell(const TempDir& dir, const std::string& script) {
  Step step;
  step.command = {"/bin/sh", "-c", script};
  step.log_path = dir / "log.txt";
  return step;
}

// Steps of a job are in order; those behind a failure are left out, other jobs
// are not.
TEST(Jobs, ChainsEndAtAFailure) {
  const TempDir dir;
  std::vector<std::string> events;
  Job bad, good;
  bad.steps = {Shell(dir, "echo 'prog: error: too bad'; exit 3"),
               Shell(dir, "exit 0")};
  bad.steps[1].before = [&] { events.push_back("must not be"); };
  bad.failed = [&](const std::string& problem) { events.push_back(problem); };
  good.steps = {Shell(dir, "touch " + dir / "a"),
                Step(),
                Shell(dir, "test -e " + dir / "a")};
  good.steps[1].after = [&](const Finished&) { events.push_back("between"); };
  good.steps[2].after = [&](const Finished&) { events.push_back("end"); };
  RunJobs({bad, good}, 1);
  ASSERT_EQ(events.size(), 3u);
  EXPECT_NE(events[0].find("code 3: too bad"), std::string::npos) << events[0];
  EXPECT_EQ(events[1], "between");
  EXPECT_EQ(events[2], "end");
}

TEST(Jobs, AMissingProgramIsAFailure) {
  const TempDir dir;
  Job job;
  Step step;
  step.command = {dir / "no_such_program"};
  step.log_path = dir / "log.txt";
  job.steps = {step};
  std::string problem;
  job.failed = [&](const std::string& text) { problem = text; };
  RunJobs({job}, 2);
  EXPECT_NE(problem.find("no_such_program"), std::string::npos);
}

// A child writes its id and then waits for longer than the test may take.
class Sleeper {
 public:
  explicit Sleeper(const TempDir& dir) : file_(dir / "pid") {
    step = Shell(dir,
                 "echo $$ > " + file_ + ".new; mv " + file_ + ".new " + file_ +
                     "; exec sleep 1000");
  }
  bool Started() const { return std::filesystem::exists(file_); }
  bool Alive() const { return kill(std::stoi(ReadFile(file_)), 0) == 0; }

  Step step;

 private:
  std::string file_;
};

// Breaks if Ctrl-C leaves programs behind that go on writing.
TEST(Jobs, AnInterruptKillsWhatRuns) {
  const TempDir dir;
  const Sleeper sleeper(dir);
  Job waiting, interrupting;
  waiting.steps = {sleeper.step};
  interrupting.steps = {
      Shell(dir, "while ! test -e " + dir / "pid" + "; do sleep 0.01; done")};
  interrupting.steps[0].after = [](const Finished&) { raise(SIGTERM); };
  EXPECT_THROW(RunJobs({waiting, interrupting}, 2), Interrupted);
  ASSERT_TRUE(sleeper.Started());
  EXPECT_FALSE(sleeper.Alive());
}

TEST(Jobs, AnExceptionKillsWhatRuns) {
  const TempDir dir;
  const Sleeper sleeper(dir);
  Job waiting, throwing;
  waiting.steps = {sleeper.step};
  throwing.steps = {
      Shell(dir, "while ! test -e " + dir / "pid" + "; do sleep 0.01; done")};
  throwing.steps[0].after = [](const Finished&) {
    throw OptionsError("differs");
  };
  EXPECT_THROW(RunJobs({waiting, throwing}, 2), OptionsError);
  ASSERT_TRUE(sleeper.Started());
  EXPECT_FALSE(sleeper.Alive());
}

}  // namespace
}  // namespace facet
