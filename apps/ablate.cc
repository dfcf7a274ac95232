// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// facet-ablate: a matrix of flags x scans, every run from a copy of one state,
// compared in tables and plots.
#include <gflags/gflags.h>

#include <cmath>
#include <cstdio>
#include <filesystem>

#include "ablate/ablation.h"
#include "ablate/html_page.h"
#include "ablate/jobs.h"
#include "ablate/plots.h"
#include "ablate/tables.h"
#include "apps/ablate_plan.h"
#include "apps/flags/formulation_list.h"
#include "apps/flags/reconstruct.h"
#include "apps/init_app.h"
#include "util/atomic_file.h"
#include "util/errors.h"

DEFINE_string(vary,
              "",
              "axes and their values, e.g. plane=anchored,raw4; "
              "schedule=4x[Phi; C+T],paper:{10x[C; Phi; T+F]}; the axis flags "
              "sets several at once: flags=paper:{--plane=raw4 "
              "--stop_decrease=0},lean:{--pose_iterations=2}");
DEFINE_string(design,
              "cross",
              "cross: all combinations; one_at_a_time: the default and every "
              "value alone against it");
DEFINE_string(scans, "", "JSON file with a list of scans");
DEFINE_string(synthetic_seeds,
              "",
              "make synthetic scans with these seeds, separated by commas");
DEFINE_string(noise_mm,
              "5",
              "synthetic scans: pose noise [mm], one scan a value and seed");
DEFINE_string(noise_deg,
              "",
              "synthetic scans: rotation noise [deg], one value for each of "
              "noise_mm; empty = 0.04 times noise_mm");
DEFINE_string(synthesize_flags,
              "",
              "synthetic scans: more flags of facet-synthesize, e.g. "
              "--frames=60 --width=320");
DEFINE_string(
    fuse_flags,
    "",
    "synthetic scans: more flags of facet-fuse, e.g. --voxel_size=0.02");
DEFINE_int32(jobs,
             1,
             "runs side by side; with --threads=0 they share the cores. For "
             "CPU times that can be compared use no more than there are cores");
DEFINE_bool(allow_different_observations,
            false,
            "keep energies of runs apart whose texels or observations differ, "
            "instead of refusing");
DEFINE_bool(list, false, "print the formulations that can be varied");
DEFINE_bool(dry_run, false, "print the matrix and what is done of it");

DECLARE_string(output);
DECLARE_string(profile);
DECLARE_int32(threads);

namespace facet {
namespace {

AblationFlags ReadFlags() {
  AblationFlags flags;
  flags.vary = FLAGS_vary;
  flags.design = FLAGS_design;
  flags.output = FLAGS_output;
  flags.scans = FLAGS_scans;
  for (const double seed :
       ParseNumbers("synthetic_seeds", FLAGS_synthetic_seeds)) {
    if (seed != std::floor(seed)) {
      throw OptionsError("--synthetic_seeds must be whole numbers");
    }
    flags.seeds.push_back(static_cast<int>(seed));
  }
  flags.noise_mm = ParseNumbers("noise_mm", FLAGS_noise_mm);
  flags.noise_deg = ParseNumbers("noise_deg", FLAGS_noise_deg);
  flags.synthesize_flags = FLAGS_synthesize_flags;
  flags.fuse_flags = FLAGS_fuse_flags;
  flags.jobs = FLAGS_jobs;
  flags.threads = FLAGS_threads;
  flags.allow_different_observations = FLAGS_allow_different_observations;
  flags.own_flags = {"vary",
                     "design",
                     "scans",
                     "synthetic_seeds",
                     "noise_mm",
                     "noise_deg",
                     "synthesize_flags",
                     "fuse_flags",
                     "jobs",
                     "allow_different_observations",
                     "list",
                     "dry_run"};
  return flags;
}

int PrintMatrix(const AblationPlan& plan) {
  const std::vector<std::string> states = RunStates(plan);
  std::printf("%zu variants of %zu scans: %zu runs in %s\n\n",
              plan.variants.size(),
              plan.scans.size(),
              states.size(),
              plan.folder.c_str());
  for (size_t v = 0; v < plan.variants.size(); ++v) {
    std::printf("variant %zu: %s\n", v + 1, plan.variants[v].label.c_str());
    for (const auto& [flag, value] : plan.variants[v].flags) {
      std::printf("    --%s=%s\n", flag.c_str(), value.c_str());
    }
  }
  std::printf("\n");
  for (size_t s = 0; s < plan.scans.size(); ++s) {
    std::printf("%s:", plan.scans[s].spec.name.c_str());
    for (size_t v = 0; v < plan.variants.size(); ++v) {
      std::printf("%s %zu %s",
                  v > 0 ? "," : "",
                  v + 1,
                  states[s * plan.variants.size() + v].c_str());
    }
    std::printf("\n");
  }
  return kExitOk;
}

void WriteOutputs(const AblationPlan& plan,
                  const std::vector<RunResult>& runs) {
  const std::string folder = plan.folder + "/";
  WriteFileAtomically(folder + "results.csv", ResultsCsv(plan, runs));
  WriteFileAtomically(folder + "trace.csv", TracesCsv(plan, runs));
  const std::string table = TableMarkdown(plan, runs);
  WriteFileAtomically(folder + "table.md", table);
  const std::vector<NamedPlot> plots = MakePlots(plan, runs);
  std::error_code ignored;
  std::filesystem::remove_all(folder + "plots", ignored);
  for (const NamedPlot& plot : plots) {
    WriteFileAtomically(folder + "plots/" + plot.file + ".svg",
                        DrawSvg(plot.plot));
  }
  WriteFileAtomically(folder + "index.html", HtmlPage(plan, runs, plots));
  std::printf("\n%s\n%sindex.html\n", table.c_str(), folder.c_str());
}

int Ablate() {
  if (FLAGS_list) {
    std::printf("%s", FormulationList().c_str());
    return kExitOk;
  }
  const AblationPlan plan = MakeAblationPlan(ReadFlags());
  if (FLAGS_dry_run) return PrintMatrix(plan);
  std::vector<RunResult> runs;
  try {
    runs = RunAblation(plan, [](const std::string& line) {
      std::printf("%s\n", line.c_str());
    });
  } catch (const Interrupted&) {
    std::fprintf(stderr,
                 "interrupted: the same command goes on where it was\n");
    return 130;
  }
  WriteFileAtomically(plan.folder + "/flags.txt",
                      FlagsText({"list", "dry_run"}));
  WriteOutputs(plan, runs);
  size_t failed = 0;
  for (const RunResult& run : runs) failed += run.problem.empty() ? 0 : 1;
  if (failed == 0) return kExitOk;
  throw UnsolvableError(std::to_string(failed) + " of " +
                        std::to_string(runs.size()) +
                        " runs failed: see the end of " + plan.folder +
                        "/table.md; the same command tries them again");
}

}  // namespace
}  // namespace facet

int main(int argc, char** argv) {
  facet::AppDescription description;
  description.usage =
      "Compares settings of facet-reconstruct on scans, all from one state.\n"
      "  facet-ablate --output=DIR --vary=\"plane=anchored,raw4\" "
      "--sequence=SCAN --mesh=DENSE.ply\nTakes all flags of facet-reconstruct "
      "as well: they hold for every run.";
  description.profile_flags = [] { return facet::ProfileFlags(FLAGS_profile); };
  description.help_filter = "apps/ablate";
  return facet::RunApp(argc, argv, description, facet::Ablate);
}
