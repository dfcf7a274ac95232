// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "ablate/ablation.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "ablate/comparison.h"
#include "ablate/jobs.h"
#include "ablate/layout.h"
#include "util/atomic_file.h"
#include "util/errors.h"
#include "util/warnings.h"

namespace facet {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

// One ablation a folder at a time.
class FolderLock {
 public:
  explicit FolderLock(const std::string& folder) {
    std::error_code error;
    fs::create_directories(folder, error);
    const std::string path = folder + "/.lock";
    file_ = open(path.c_str(), O_CREAT | O_RDWR | O_CLOEXEC, 0666);
    if (file_ < 0) {
      throw InputError("cannot write into the folder " + folder);
    }
    if (flock(file_, LOCK_EX | LOCK_NB) != 0) {
      close(file_);
      throw InputError(folder + " is in use by another facet-ablate");
    }
  }
  ~FolderLock() { close(file_); }
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int file_ = -1;
};

class Ablation {
 public:
  Ablation(const AblationPlan& plan,
           const std::function<void(const std::string&)>& print)
      : plan_(plan),
        layout_(plan),
        print_(print),
        threads_("--threads=" + std::to_string(plan.threads)),
        problems_(plan.scans.size()) {}

  std::vector<RunResult> Execute() {
    std::vector<Job> jobs;
    for (size_t s = 0; s < plan_.scans.size(); ++s) {
      Job job = StateJob(s);
      if (!job.steps.empty()) jobs.push_back(job);
    }
    RunJobs(jobs, plan_.jobs);
    MakeRuns();
    jobs.clear();
    for (size_t r = 0; r < runs_.size(); ++r) {
      if (!problems_[runs_[r].scan].empty()) {
        runs_[r].problem = problems_[runs_[r].scan];
        continue;
      }
      Job job = RunJob(r);
      if (!job.steps.empty()) jobs.push_back(job);
    }
    left_ = jobs.size();
    RunJobs(jobs, plan_.jobs);
    if (of_other_builds_ > 0) {
      AddWarning(std::to_string(of_other_builds_) + " of " +
                 std::to_string(runs_.size()) +
                 " runs were made by another build of facet-reconstruct: "
                 "remove " +
                 plan_.folder + "/runs to do them again");
    }
    return runs_;
  }

 private:
  // Scan, mesh and stages up to keyframes; no steps if all is there.
  Job StateJob(size_t s) {
    const ScanPlan& scan = plan_.scans[s];
    Job job;
    job.name = scan.spec.name;
    job.failed = [this, s](const std::string& problem) {
      problems_[s] = problem;
      print_(plan_.scans[s].spec.name + ": " + problem);
    };
    if (!layout_.StateHash(s).empty()) return job;
    const std::string folder = layout_.ScanFolder(s);
    if (scan.spec.synthetic &&
        !HasMark(folder + "/scan.json", layout_.ScanId(s))) {
      AddScanSteps(s, &job);
    }
    AddStateStep(s, &job);
    return job;
  }

  void AddScanSteps(size_t s, Job* job) {
    const ScanPlan& scan = plan_.scans[s];
    const std::string folder = layout_.ScanFolder(s);
    Step synthesize;
    synthesize.before = [this, folder, s] {
      print_(plan_.scans[s].spec.name + ": synthesize, fuse");
      fs::remove_all(folder);
    };
    synthesize.command = {layout_.Program("synthesize"),
                          "--output=" + scan.spec.sequence,
                          threads_};
    synthesize.command.insert(synthesize.command.end(),
                              scan.synthesize_args.begin(),
                              scan.synthesize_args.end());
    synthesize.log_path = folder + "/synthesize.log";
    Step fuse;
    fuse.command = {layout_.Program("fuse"),
                    "--sequence=" + scan.spec.sequence,
                    "--output=" + scan.spec.mesh,
                    threads_};
    fuse.command.insert(
        fuse.command.end(), scan.fuse_args.begin(), scan.fuse_args.end());
    fuse.log_path = folder + "/fuse.log";
    fuse.after = [this, folder, s](const Finished&) {
      const ScanPlan& done = plan_.scans[s];
      WriteMark(folder + "/scan.json",
                {{"id", layout_.ScanId(s)},
                 {"synthesize", done.synthesize_args},
                 {"fuse", done.fuse_args}});
    };
    job->steps.push_back(synthesize);
    job->steps.push_back(fuse);
  }

  void AddStateStep(size_t s, Job* job) {
    const std::string folder = layout_.StateFolder(s);
    Step state;
    state.before = [this, folder, s] {
      print_(plan_.scans[s].spec.name + ": partition, simplify, keyframes");
      fs::remove_all(folder);
      WriteFileAtomically(folder + "/state.flags", plan_.scans[s].state_flags);
    };
    state.command = {layout_.Program("reconstruct"),
                     "--flagfile=" + folder + "/state.flags",
                     "--output=" + folder,
                     "--to_stage=keyframes",
                     "--overwrite",
                     threads_};
    state.log_path = folder + "/log.txt";
    state.after = [this, folder, s](const Finished&) {
      WriteMark(folder + "/state.json",
                {{"id", layout_.StateId(s)},
                 {"settings", plan_.scans[s].state_settings},
                 {"hash", HashOfState(folder)}});
    };
    job->steps.push_back(state);
  }

  void MakeRuns() {
    for (size_t s = 0; s < plan_.scans.size(); ++s) {
      const std::string hash = layout_.StateHash(s);
      for (size_t v = 0; v < plan_.variants.size(); ++v) {
        runs_.push_back(layout_.Run(s, v, hash));
      }
    }
  }

  // What is left to do for a run; what is done is read at once.
  Job RunJob(size_t r) {
    const RunResult& run = runs_[r];
    const Progress progress = layout_.ProgressOf(run);
    Job job;
    job.name = Name(run);
    job.failed = [this, r](const std::string& problem) {
      runs_[r].problem = problem;
      print_(Counter() + Name(runs_[r]) + ": " + problem);
    };
    if (progress == Progress::kEvaluated) {
      Read(r);
      return job;
    }
    if (progress == Progress::kNothing) job.steps.push_back(ReconstructStep(r));
    job.steps.push_back(EvaluateStep(r));
    return job;
  }

  Step ReconstructStep(size_t r) {
    const RunResult run = runs_[r];
    const std::string flags = plan_.scans[run.scan].run_flags[run.variant];
    Step step;
    step.before = [this, run, flags] {
      fs::remove_all(run.folder);
      CopyState(layout_.StateFolder(run.scan), run.folder);
      WriteFileAtomically(run.folder + "/run.flags", flags);
    };
    step.command = {layout_.Program("reconstruct"),
                    "--flagfile=" + run.folder + "/run.flags",
                    "--output=" + run.folder,
                    "--from_stage=photometric",
                    "--overwrite",
                    threads_};
    step.log_path = run.folder + "/log.txt";
    step.after = [this, run](const Finished& finished) {
      json flags_set = json::object();
      for (const auto& [flag, value] : plan_.variants[run.variant].flags) {
        flags_set[flag] = value;
      }
      WriteMark(run.folder + "/run.json",
                {{"id", run.id},
                 {"scan", plan_.scans[run.scan].spec.name},
                 {"variant", plan_.variants[run.variant].label},
                 {"flags", flags_set},
                 {"state", layout_.StateHash(run.scan)},
                 {"build", layout_.Build()},
                 {"run_wall_s", finished.wall_s},
                 {"run_cpu_s", finished.cpu_s}});
    };
    return step;
  }

  Step EvaluateStep(size_t r) {
    const RunResult run = runs_[r];
    const ScanPlan& scan = plan_.scans[run.scan];
    Step step;
    step.before = [run] { fs::remove(run.folder + "/evaluation.json"); };
    if (!scan.evaluate_args.empty()) {
      step.command = {layout_.Program("evaluate"),
                      "--model=" + run.folder,
                      "--output=" + run.folder + "/evaluation.json",
                      threads_};
      step.command.insert(step.command.end(),
                          scan.evaluate_args.begin(),
                          scan.evaluate_args.end());
      step.log_path = run.folder + "/evaluate.log";
    }
    step.after = [this, r, run](const Finished&) {
      json mark = ReadMark(run.folder + "/run.json");
      mark["evaluation"] = layout_.EvaluationId(run.scan);
      WriteMark(run.folder + "/run.json", mark);
      Read(r);
      const RunResult& done = runs_[r];
      char text[200];
      std::snprintf(text,
                    sizeof(text),
                    "E_tex %.5g -> %.5g, %.1f CPU s",
                    done.trace[0].e_tex,
                    done.Get("E_tex"),
                    done.Get("cpu_s"));
      print_(Counter() + Name(done) + ": " + text);
    };
    return step;
  }

  void Read(size_t r) {
    RunResult run = runs_[r];
    ReadRun(run.folder, plan_.scans[run.scan].held_out, &run);
    const json mark = ReadMark(run.folder + "/run.json");
    run.figures[FigureIndex("run_wall_s")] = mark.value("run_wall_s", 0.0);
    run.figures[FigureIndex("run_cpu_s")] = mark.value("run_cpu_s", 0.0);
    of_other_builds_ += mark.value("build", "") != layout_.Build() ? 1 : 0;
    if (!plan_.allow_different_observations) {
      CheckSameObservations(plan_, run, runs_);
    }
    runs_[r] = run;
  }

  std::string Name(const RunResult& run) const {
    return plan_.scans[run.scan].spec.name + " | " +
           plan_.variants[run.variant].label;
  }
  std::string Counter() {
    return "[" + std::to_string(++ended_) + "/" + std::to_string(left_) + "] ";
  }

  const AblationPlan& plan_;
  const Layout layout_;
  const std::function<void(const std::string&)>& print_;
  const std::string threads_;
  std::vector<std::string> problems_;  // by scan
  std::vector<RunResult> runs_;
  size_t left_ = 0, ended_ = 0, of_other_builds_ = 0;
};

}  // namespace

std::vector<RunResult> RunAblation(
    const AblationPlan& plan,
    const std::function<void(const std::string&)>& print) {
  const FolderLock lock(plan.folder);
  std::vector<RunResult> runs = Ablation(plan, print).Execute();
  CompareRuns(&runs);
  return runs;
}

std::vector<std::string> RunStates(const AblationPlan& plan) {
  const Layout layout(plan);
  std::vector<std::string> states;
  for (size_t s = 0; s < plan.scans.size(); ++s) {
    const std::string hash = layout.StateHash(s);
    for (size_t v = 0; v < plan.variants.size(); ++v) {
      const bool done =
          !hash.empty() &&
          layout.ProgressOf(layout.Run(s, v, hash)) == Progress::kEvaluated;
      states.push_back(done ? "done" : "to do");
    }
  }
  return states;
}

}  // namespace facet
