// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "ablate/ablation.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cctype>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "ablate/comparison.h"
#include "ablate/jobs.h"
#include "util/atomic_file.h"
#include "util/errors.h"
#include "util/hash.h"

namespace facet {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

// The artefacts that runs begin from.
const char* const kStateFiles[] = {
    "stages/partition.bin", "stages/simplify.bin", "stages/keyframes.bin"};

std::string HashOf(const std::vector<std::string>& texts) {
  Hash64 hash;
  for (const std::string& text : texts) hash.Add(text);
  return hash.Text();
}

// A mark that cannot be read is no mark.
json ReadMark(const std::string& path) {
  if (!fs::exists(path)) return json();
  return json::parse(ReadFile(path), nullptr, false);
}

bool HasMark(const std::string& path, const std::string& id) {
  const json mark = ReadMark(path);
  return mark.is_object() && mark.value("id", "") == id;
}

void WriteMark(const std::string& path, const json& mark) {
  WriteFileAtomically(path, mark.dump(1) + "\n");
}

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

// Part of a file name that still tells the variant.
std::string Slug(const std::string& label) {
  std::string slug;
  for (const char c : label) {
    if (std::isalnum(static_cast<unsigned char>(c))) {
      slug += c;
    } else if (!slug.empty() && slug.back() != '-') {
      slug += '-';
    }
    if (slug.size() >= 40) break;
  }
  while (!slug.empty() && slug.back() == '-') slug.pop_back();
  return slug;
}

// The paths and identities of a plan.
class Layout {
 public:
  explicit Layout(const AblationPlan& plan) : plan_(plan) {}

  std::string ScanFolder(size_t s) const { return Folder("scans", s); }
  std::string StateFolder(size_t s) const { return Folder("states", s); }
  std::string Program(const std::string& name) const {
    return plan_.programs + "/facet-" + name;
  }

  std::string ScanId(size_t s) const {
    std::vector<std::string> texts = plan_.scans[s].synthesize_args;
    for (const std::string& arg : plan_.scans[s].fuse_args) {
      texts.push_back(arg);
    }
    return HashOf(texts);
  }
  std::string StateId(size_t s) const {
    return HashOf({plan_.scans[s].state_settings, ScanId(s)});
  }
  // Empty while there is no state.
  std::string StateHash(size_t s) const {
    const json mark = ReadMark(StateFolder(s) + "/state.json");
    if (!mark.is_object() || mark.value("id", "") != StateId(s)) return "";
    return mark.value("hash", "");
  }
  RunResult Run(size_t s, size_t v, const std::string& state_hash) const {
    RunResult run;
    run.scan = s;
    run.variant = v;
    run.id = HashOf({plan_.scans[s].run_flags[v], state_hash});
    run.folder = Folder("runs", s) + "/" + Slug(plan_.variants[v].label) + "_" +
                 run.id.substr(0, 8);
    return run;
  }
  std::string EvaluationId(size_t s) const {
    return HashOf(plan_.scans[s].evaluate_args);
  }
  // 0 = nothing, 1 = reconstructed, 2 = evaluated as well.
  int Progress(const RunResult& run) const {
    const json mark = ReadMark(run.folder + "/run.json");
    if (!mark.is_object() || mark.value("id", "") != run.id) return 0;
    return mark.value("evaluation", "") == EvaluationId(run.scan) ? 2 : 1;
  }

 private:
  std::string Folder(const std::string& kind, size_t s) const {
    return plan_.folder + "/" + kind + "/" + plan_.scans[s].spec.name;
  }

  const AblationPlan& plan_;
};

std::string HashOfState(const std::string& folder) {
  Hash64 hash;
  for (const char* file : kStateFiles) hash.Add(ReadFile(folder + "/" + file));
  return hash.Text();
}

// A link where the file system has them: facet replaces files and never writes
// into one, so the state stays what it is, and stages are large.
void CopyState(const std::string& from, const std::string& to) {
  fs::create_directories(to + "/stages");
  for (const char* file : kStateFiles) {
    std::error_code error;
    fs::create_hard_link(from + "/" + file, to + "/" + file, error);
    if (error) fs::copy_file(from + "/" + file, to + "/" + file);
  }
}

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
    const int progress = layout_.Progress(run);
    Job job;
    job.name = Name(run);
    job.failed = [this, r](const std::string& problem) {
      runs_[r].problem = problem;
      print_(Counter() + Name(runs_[r]) + ": " + problem);
    };
    if (progress == 2) {
      Read(r);
      return job;
    }
    if (progress == 0) job.steps.push_back(ReconstructStep(r));
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
  size_t left_ = 0, ended_ = 0;
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
          !hash.empty() && layout.Progress(layout.Run(s, v, hash)) == 2;
      states.push_back(done ? "done" : "to do");
    }
  }
  return states;
}

}  // namespace facet
