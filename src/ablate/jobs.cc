// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "ablate/jobs.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>

#include "util/errors.h"

namespace facet {
namespace {

using Clock = std::chrono::steady_clock;

volatile std::sig_atomic_t g_interrupted = 0;

void NoteInterrupt(int) { g_interrupted = 1; }

// Catches SIGINT and SIGTERM while it lives.
class InterruptGuard {
 public:
  InterruptGuard() {
    g_interrupted = 0;
    struct sigaction action {};
    action.sa_handler = NoteInterrupt;
    sigaction(SIGINT, &action, &old_int_);
    sigaction(SIGTERM, &action, &old_term_);
  }
  ~InterruptGuard() {
    sigaction(SIGINT, &old_int_, nullptr);
    sigaction(SIGTERM, &old_term_, nullptr);
  }
  InterruptGuard(const InterruptGuard&) = delete;
  InterruptGuard& operator=(const InterruptGuard&) = delete;

 private:
  struct sigaction old_int_ {
  }, old_term_{};
};

double Seconds(const timeval& t) {
  return static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_usec);
}

// What the program said was wrong, or how it ended.
std::string Problem(const Step& step, int status) {
  std::ifstream log(step.log_path);
  const std::string mark = "error: ";
  std::string sentence;
  for (std::string line; std::getline(log, line);) {
    const size_t at = line.find(mark);
    if (at != std::string::npos) sentence = line.substr(at + mark.size());
  }
  const std::string program =
      std::filesystem::path(step.command.front()).filename().string();
  const std::string end =
      WIFSIGNALED(status)
          ? "was killed by signal " + std::to_string(WTERMSIG(status))
          : "ended with code " + std::to_string(WEXITSTATUS(status));
  return program + " " + end +
         (sentence.empty() ? ", see " + step.log_path : ": " + sentence);
}

[[noreturn]] void Execute(char* const* argv, const char* log, pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(127);  // it died before the line above
  const int out = open(log, O_CREAT | O_APPEND | O_WRONLY, 0666);
  const int in = open("/dev/null", O_RDONLY);
  if (out >= 0) {
    dup2(out, STDOUT_FILENO);
    dup2(out, STDERR_FILENO);
  }
  if (in >= 0) dup2(in, STDIN_FILENO);
  execv(argv[0], argv);
  _exit(127);
}

class Runner {
 public:
  Runner(const std::vector<Job>& jobs, int slots)
      : jobs_(jobs), slots_(static_cast<size_t>(slots)) {}
  ~Runner() { KillAll(); }
  Runner(const Runner&) = delete;
  Runner& operator=(const Runner&) = delete;

  void Run() {
    size_t next = 0;
    while (next < jobs_.size() || !running_.empty()) {
      if (g_interrupted) throw Interrupted();
      if (next < jobs_.size() && running_.size() < slots_) {
        Begin(next++, 0);
        continue;
      }
      if (!Poll()) usleep(10000);
    }
  }

 private:
  struct Running {
    size_t job = 0, step = 0;
    pid_t pid = 0;
    Clock::time_point start;
  };

  // Goes on with a job until a command runs or nothing is left.
  void Begin(size_t job, size_t first_step) {
    for (size_t s = first_step; s < jobs_[job].steps.size(); ++s) {
      const Step& step = jobs_[job].steps[s];
      if (step.before) step.before();
      if (!step.command.empty()) {
        running_.push_back({job, s, Start(step), Clock::now()});
        return;
      }
      if (step.after) step.after({});
    }
  }

  static pid_t Start(const Step& step) {
    std::vector<char*> argv;
    for (const std::string& word : step.command) {
      argv.push_back(const_cast<char*>(word.c_str()));
    }
    argv.push_back(nullptr);
    std::filesystem::create_directories(
        std::filesystem::path(step.log_path).parent_path());
    std::filesystem::remove(step.log_path);
    const pid_t parent = getpid();
    const pid_t pid = fork();
    if (pid < 0) {
      throw UnsolvableError("cannot start " + step.command.front() +
                            ": no more processes or memory, lower --jobs");
    }
    if (pid == 0) Execute(argv.data(), step.log_path.c_str(), parent);
    return pid;
  }

  // Handles one command that has ended; false if none has.
  bool Poll() {
    for (size_t i = 0; i < running_.size(); ++i) {
      int status = 0;
      rusage usage{};
      if (wait4(running_[i].pid, &status, WNOHANG, &usage) == 0) continue;
      const Running done = running_[i];
      running_.erase(running_.begin() + static_cast<std::ptrdiff_t>(i));
      if (g_interrupted) throw Interrupted();
      const Job& job = jobs_[done.job];
      const Step& step = job.steps[done.step];
      if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
        if (job.failed) job.failed(Problem(step, status));
        return true;
      }
      const std::chrono::duration<double> wall = Clock::now() - done.start;
      if (step.after) {
        step.after(
            {wall.count(), Seconds(usage.ru_utime) + Seconds(usage.ru_stime)});
      }
      Begin(done.job, done.step + 1);
      return true;
    }
    return false;
  }

  void KillAll() {
    for (const Running& r : running_) kill(r.pid, SIGKILL);
    for (const Running& r : running_) waitpid(r.pid, nullptr, 0);
    running_.clear();
  }

  const std::vector<Job>& jobs_;
  const size_t slots_;
  std::vector<Running> running_;
};

}  // namespace

void RunJobs(const std::vector<Job>& jobs, int slots) {
  const InterruptGuard guard;
  Runner(jobs, slots).Run();
}

}  // namespace facet
