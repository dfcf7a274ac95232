// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "apps/ablate_plan.h"

#include <gflags/gflags.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <thread>

#include "apps/flags/choices.h"
#include "apps/flags/reconstruct.h"
#include "apps/init_app.h"
#include "pipeline/reconstruct.h"
#include "schedule/schedule.h"
#include "util/errors.h"

namespace facet {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

// Flags that say where and how a run is done, not what it computes.
const std::set<std::string>& RunFlags() {
  static const auto* const kFlags = new std::set<std::string>{"sequence",
                                                              "mesh",
                                                              "output",
                                                              "overwrite",
                                                              "from_stage",
                                                              "to_stage",
                                                              "previews",
                                                              "profile",
                                                              "threads",
                                                              "trace_states"};
  return *kFlags;
}

std::string ValueOf(const std::string& flag) {
  std::string value;
  gflags::GetCommandLineOption(flag.c_str(), &value);
  return value;
}

void SetFlag(const std::string& flag, const std::string& value) {
  if (gflags::SetCommandLineOption(flag.c_str(), value.c_str()).empty()) {
    throw OptionsError("--" + flag + "=" + value +
                       ": the flag does not exist or does not take this value");
  }
}

// The value as gflags writes it: 0.10 and 0.1 are the same number.
std::string Canonical(const std::string& flag, const std::string& value) {
  const gflags::FlagSaver saver;
  SetFlag(flag, value);
  return ValueOf(flag);
}

bool IsFlagOfFile(const gflags::CommandLineFlagInfo& flag,
                  const std::string& file) {
  return flag.filename.size() >= file.size() &&
         flag.filename.compare(
             flag.filename.size() - file.size(), file.size(), file) == 0;
}

// --name=value of the flags of a file under apps/, but for `without`.
std::vector<std::string> ArgsOfFile(const std::string& file,
                                    const std::string& without) {
  std::vector<gflags::CommandLineFlagInfo> flags;
  gflags::GetAllFlags(&flags);
  std::vector<std::string> args;
  for (const gflags::CommandLineFlagInfo& flag : flags) {
    if (!IsFlagOfFile(flag, file) || flag.name == without) continue;
    args.push_back("--" + flag.name + "=" + flag.current_value);
  }
  return args;
}

void Append(const std::vector<std::string>& more,
            std::vector<std::string>* args) {
  args->insert(args->end(), more.begin(), more.end());
}

void AppendFlagSet(const std::string& text, std::vector<std::string>* args) {
  for (const auto& [flag, value] : ParseFlagSet(text)) {
    args->push_back("--" + flag + "=" + value);
  }
}

std::vector<std::string> FormulationFlags() {
  std::vector<std::string> names;
  for (const FlagChoices& row : AllFlagChoices()) {
    if (row.formulation) names.push_back(row.flag);
  }
  return names;
}

class PlanMaker {
 public:
  explicit PlanMaker(const AblationFlags& flags) : flags_(flags) {
    not_for_runs_ = flags.own_flags;
    for (const char* name :
         {"output", "overwrite", "from_stage", "to_stage", "threads"}) {
      not_for_runs_.insert(name);
    }
  }

  AblationPlan Make() {
    if (flags_.output.empty()) {
      throw OptionsError(
          "--output is missing: name the folder of the ablation");
    }
    if (flags_.vary.empty()) {
      throw OptionsError(
          "--vary is missing: say what to vary, e.g. "
          "--vary=plane=anchored,raw4, or see --list");
    }
    if (flags_.jobs < 1) throw OptionsError("--jobs must be at least 1");
    plan_.folder = AbsolutePath(flags_.output);
    plan_.programs = fs::read_symlink("/proc/self/exe").parent_path();
    plan_.jobs = flags_.jobs;
    plan_.threads = flags_.threads;
    if (plan_.threads == 0 && plan_.jobs > 1) {
      const int cores = static_cast<int>(std::thread::hardware_concurrency());
      plan_.threads = std::max(1, cores / plan_.jobs);
    }
    plan_.allow_different_observations = flags_.allow_different_observations;
    plan_.axes = ParseVary(
        flags_.vary,
        {[this](const std::string& flag) { return FlagProblem(flag); },
         [this](const std::string& flag, const std::string& value) {
           return ValueProblem(flag, value);
         }});
    MakeVariants();
    for (const ScanSpec& spec : Scans()) plan_.scans.push_back(PlanScan(spec));
    return plan_;
  }

 private:
  static std::string AbsolutePath(const std::string& path) {
    std::string clean = fs::absolute(path).lexically_normal().string();
    while (clean.size() > 1 && clean.back() == '/') clean.pop_back();
    return clean;
  }

  bool CanVary(const std::string& flag) const {
    gflags::CommandLineFlagInfo info;
    return gflags::GetCommandLineFlagInfo(flag.c_str(), &info) &&
           info.filename.find("apps/") != std::string::npos &&
           flags_.own_flags.count(flag) == 0 && RunFlags().count(flag) == 0;
  }

  std::string FlagProblem(const std::string& flag) const {
    if (flag == kFlagSetAxis || CanVary(flag)) return "";
    if (flag.compare(0, 5, "noise") == 0 || flag == "seed") {
      return "'" + flag + "' is varied by --synthetic_seeds, --noise_mm";
    }
    return "'" + flag + "' cannot be varied: expected one of " +
           JoinValues(FormulationFlags()) + ", " + kFlagSetAxis +
           " (several at once), or another setting of facet-reconstruct";
  }

  std::string ValueProblem(const std::string& flag,
                           const std::string& value) const {
    if (flag == kFlagSetAxis) return FlagSetProblem(value);
    const FlagChoices* choices = FindFlagChoices(flag);
    if (choices != nullptr && !choices->values.empty() &&
        std::find(choices->values.begin(), choices->values.end(), value) ==
            choices->values.end()) {
      return "expected one of " + JoinValues(choices->values);
    }
    if (flag == "schedule") {
      try {
        // What is possible depends on --joint, checked with the whole variant.
        ParseSchedule(value, JointMethod::kSchur);
      } catch (const OptionsError& e) {
        return e.what();
      }
    }
    const gflags::FlagSaver saver;
    if (gflags::SetCommandLineOption(flag.c_str(), value.c_str()).empty()) {
      return "expected a value of type " +
             gflags::GetCommandLineFlagInfoOrDie(flag.c_str()).type;
    }
    return "";
  }

  std::string FlagSetProblem(const std::string& text) const {
    try {
      for (const auto& [flag, value] : ParseFlagSet(text)) {
        std::string problem = FlagProblem(flag);
        if (flag == kFlagSetAxis) problem = "flags cannot be inside flags";
        if (problem.empty()) problem = ValueProblem(flag, value);
        if (!problem.empty()) return "--" + flag + ": " + problem;
      }
    } catch (const OptionsError& e) {
      return e.what();
    }
    return "";
  }

  void MakeVariants() {
    std::vector<std::string> defaults;
    for (const VaryAxis& axis : plan_.axes) {
      std::string text;
      for (const VaryValue& value : axis.values) {
        if (axis.flag != kFlagSetAxis &&
            Canonical(axis.flag, value.text) == ValueOf(axis.flag)) {
          text = value.text;
        }
      }
      defaults.push_back(text);
    }
    if (flags_.design != "cross" && flags_.design != "one_at_a_time") {
      throw OptionsError("--design=" + flags_.design +
                         " is not possible: use cross, one_at_a_time");
    }
    plan_.variants = ExpandMatrix(
        plan_.axes,
        flags_.design == "cross" ? Design::kCross : Design::kOneAtATime,
        defaults);
  }

  std::vector<ScanSpec> Scans() const {
    std::vector<ScanSpec> scans = SyntheticScans(flags_.seeds,
                                                 flags_.noise_mm,
                                                 flags_.noise_deg,
                                                 plan_.folder + "/scans");
    if (!flags_.scans.empty()) {
      for (const ScanSpec& scan : ReadScans(flags_.scans)) {
        scans.push_back(scan);
      }
    }
    if (!ValueOf("sequence").empty()) {
      ScanSpec scan;
      scan.name = scan.group = "scan";
      scan.sequence = AbsolutePath(ValueOf("sequence"));
      scan.mesh = AbsolutePath(ValueOf("mesh"));
      scans.push_back(scan);
    }
    if (scans.empty()) {
      throw OptionsError(
          "no scans: give --scans, --synthetic_seeds, or --sequence and "
          "--mesh");
    }
    for (size_t i = 0; i < scans.size(); ++i) {
      for (size_t j = 0; j < i; ++j) {
        if (scans[i].name != scans[j].name) continue;
        throw OptionsError("two scans are called '" + scans[i].name + "'");
      }
    }
    return scans;
  }

  ScanPlan PlanScan(const ScanSpec& spec) const {
    const gflags::FlagSaver saver;
    ScanPlan scan;
    scan.spec = spec;
    for (const auto& [flag, value] : ParseFlagSet(spec.flags)) {
      if (!CanVary(flag)) {
        throw OptionsError("scan " + spec.name + ": " + FlagProblem(flag));
      }
      SetFlag(flag, value);
    }
    SetFlag("sequence", spec.sequence);
    SetFlag("mesh", spec.mesh);
    const json settings = StateSettings(ReconstructOptionsFromFlags());
    scan.state_settings = settings.dump();
    scan.state_flags = FlagsText(not_for_runs_);
    scan.held_out = std::atoi(ValueOf("holdout_stride").c_str()) > 0;
    PlanEvaluation(&scan);
    if (spec.synthetic) PlanSynthesis(&scan);
    for (const Variant& variant : plan_.variants) {
      scan.run_flags.push_back(RunFlagsOf(spec, variant, settings));
    }
    CheckThatVariantsDiffer(scan);
    return scan;
  }

  void CheckThatVariantsDiffer(const ScanPlan& scan) const {
    for (size_t i = 0; i < scan.run_flags.size(); ++i) {
      for (size_t j = 0; j < i; ++j) {
        if (scan.run_flags[i] != scan.run_flags[j]) continue;
        throw OptionsError("--vary: the variants '" + plan_.variants[j].label +
                           "' and '" + plan_.variants[i].label +
                           "' are the same settings: leave one out");
      }
    }
  }

  // What the artefacts that all runs begin from depend on.
  static json StateSettings(const ReconstructOptions& options) {
    json settings = {{"mesh", {{"path", options.mesh_path}}}};
    for (const Stage stage :
         {Stage::kPartition, Stage::kSimplify, Stage::kKeyframes}) {
      settings[StageName(stage)] = StageSettings(options, stage);
    }
    return settings;
  }

  std::string RunFlagsOf(const ScanSpec& spec,
                         const Variant& variant,
                         const json& state_settings) const {
    const gflags::FlagSaver saver;
    for (const auto& [flag, value] : variant.flags) SetFlag(flag, value);
    // For the curves of the errors.
    if (HasTruth(spec)) SetFlag("trace_states", "true");
    json settings;
    try {
      const ReconstructOptions options = ReconstructOptionsFromFlags();
      CheckOptions(options);
      settings = StateSettings(options);
    } catch (const OptionsError& e) {
      throw OptionsError("variant '" + variant.label + "' of " + spec.name +
                         ": " + e.what());
    }
    for (const auto& [stage, values] : settings.items()) {
      for (const auto& [key, value] : values.items()) {
        if (value == state_settings[stage][key]) continue;
        throw OptionsError(
            "variant '" + variant.label + "' changes " + key +
            " of the stage " + stage +
            ", but all runs begin from one state after the stage keyframes: "
            "make an ablation for each value, with the value as a flag");
      }
    }
    return FlagsText(not_for_runs_);
  }

  static bool HasTruth(const ScanSpec& spec) {
    return !spec.true_poses.empty() || !spec.true_planes.empty();
  }

  static void PlanEvaluation(ScanPlan* scan) {
    const ScanSpec& spec = scan->spec;
    if (!scan->held_out && !HasTruth(spec)) return;
    scan->evaluate_args = ArgsOfFile("apps/flags/sequence.cc", "");
    std::vector<std::string>* args = &scan->evaluate_args;
    if (scan->held_out) {
      args->push_back("--frames_stride=" + ValueOf("holdout_stride"));
      args->push_back("--frames_offset=" + ValueOf("holdout_offset"));
    } else {
      args->push_back("--photos=false");
    }
    if (!spec.true_poses.empty()) {
      args->push_back("--true_poses=" + spec.true_poses);
    }
    if (!spec.true_planes.empty()) {
      args->push_back("--true_planes=" + spec.true_planes);
      args->push_back("--true_mesh=" + spec.true_mesh);
    }
  }

  void PlanSynthesis(ScanPlan* scan) const {
    const ScanSpec& spec = scan->spec;
    std::ostringstream seed, mm, deg;
    seed << "--seed=" << spec.seed;
    mm << "--pose_noise_mm=" << spec.noise_mm;
    deg << "--pose_noise_deg=" << spec.noise_deg;
    scan->synthesize_args = {seed.str(), mm.str(), deg.str()};
    AppendFlagSet(flags_.synthesize_flags, &scan->synthesize_args);
    scan->fuse_args = ArgsOfFile("apps/flags/sequence.cc", "sequence");
    Append(ArgsOfFile("apps/flags/holdout.cc", ""), &scan->fuse_args);
    AppendFlagSet(flags_.fuse_flags, &scan->fuse_args);
  }

  const AblationFlags& flags_;
  std::set<std::string> not_for_runs_;
  AblationPlan plan_;
};

}  // namespace

AblationPlan MakeAblationPlan(const AblationFlags& flags) {
  return PlanMaker(flags).Make();
}

std::vector<double> ParseNumbers(const std::string& flag,
                                 const std::string& text) {
  std::vector<double> numbers;
  std::stringstream stream(text);
  for (std::string part; std::getline(stream, part, ',');) {
    char* end = nullptr;
    const double number = std::strtod(part.c_str(), &end);
    if (part.empty() || *end != '\0' || !(number >= 0) || number > 1e9) {
      throw OptionsError("--" + flag + "=" + text + ": '" + part +
                         "' is no number from 0 on; separate them by commas");
    }
    numbers.push_back(number);
  }
  return numbers;
}

}  // namespace facet
