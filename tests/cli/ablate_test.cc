// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// facet-ablate: what it writes, what it refuses, and that it goes on after a
// kill.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <map>
#include <sstream>

#include "tests/cli/cli_run.h"
#include "util/atomic_file.h"
#include "util/errors.h"

namespace facet {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> Arguments(const std::string& output,
                                   const std::vector<std::string>& extra) {
  std::vector<std::string> arguments = {"--flagfile=" + Fixture("small.flags"),
                                        "--sequence=" + Fixture("scan"),
                                        "--mesh=" + Fixture("dense.ply"),
                                        "--output=" + output};
  arguments.insert(arguments.end(), extra.begin(), extra.end());
  return arguments;
}

Outcome Ablate(const std::string& output,
               const std::vector<std::string>& extra) {
  return RunProgram("ablate", Arguments(output, extra), 110);
}

// A CSV file by column; no cell of these tests holds a comma or a quote.
std::vector<std::map<std::string, std::string>> ReadCsv(
    const std::string& path) {
  std::istringstream lines(ReadFile(path));
  std::vector<std::string> heads;
  std::vector<std::map<std::string, std::string>> rows;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream cells(line);
    std::vector<std::string> row;
    for (std::string cell; std::getline(cells, cell, ',');) row.push_back(cell);
    if (heads.empty()) {
      heads = row;
      continue;
    }
    rows.emplace_back();
    for (size_t i = 0; i < heads.size() && i < row.size(); ++i) {
      rows.back()[heads[i]] = row[i];
    }
  }
  return rows;
}

std::vector<std::map<std::string, std::string>> Results(
    const std::string& folder) {
  return ReadCsv(folder + "/results.csv");
}

// run.json of each finished run, with the time it was written.
std::map<std::string, fs::file_time_type> FinishedRuns(
    const std::string& folder) {
  std::map<std::string, fs::file_time_type> runs;
  if (!fs::exists(folder + "/runs")) return runs;
  for (const auto& entry : fs::recursive_directory_iterator(folder + "/runs")) {
    if (entry.path().filename() == "run.json") {
      runs[entry.path()] = entry.last_write_time();
    }
  }
  return runs;
}

// All outputs; a second call computes nothing, one with a further value only
// that value. Energies are those of facet-reconstruct.
TEST(CliAblate, WritesItsOutputsAndSkipsWhatIsDone) {
  const TempDir dir;
  const std::string folder = dir / "abl";
  ExpectSuccess(Ablate(folder, {"--vary=plane=anchored,raw4"}));
  for (const char* file :
       {"results.csv", "trace.csv", "table.md", "index.html", "flags.txt"}) {
    EXPECT_TRUE(fs::exists(folder + "/" + file)) << file;
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(folder + "/plots"),
                          fs::directory_iterator()),
            6);
  ExpectNoPartialFile(folder);
  const auto rows = Results(folder);
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].at("plane"), "anchored");
  EXPECT_EQ(rows[1].at("plane"), "raw4");
  EXPECT_EQ(rows[1].at("status"), "ok");
  EXPECT_EQ(rows[1].at("comparable"), "yes");
  const nlohmann::json report = ReadJson(Fixture("run/report.json"));
  EXPECT_EQ(rows[0].at("observation_fingerprint"),
            report["observation_fingerprint"]);
  EXPECT_NEAR(std::stod(rows[0].at("E_tex")),
              report["energy"]["final"]["E_tex"].get<double>(),
              1e-8 * report["energy"]["final"]["E_tex"].get<double>());

  const auto before = FinishedRuns(folder);
  ASSERT_EQ(before.size(), 2u);
  ExpectSuccess(
      Ablate(folder, {"--vary=plane=raw4,anchored; gauge=mean,none"}));
  const auto after = FinishedRuns(folder);
  EXPECT_EQ(after.size(), 2u + 2u) << "with the default gauge they were there";
  ExpectSuccess(Ablate(folder, {"--vary=plane=anchored,raw4"}));
  for (const auto& [run, time] : before) {
    EXPECT_EQ(FinishedRuns(folder).at(run), time) << run << " was run again";
  }
}

// What docs/add-a-residual.md promises: a term of terms/term_kinds.cc has a row
// without a line of code in facet-ablate. Breaks if the term does nothing, or
// if its energies are no longer those of the paper's terms.
TEST(CliAblate, HasARowForATerm) {
  const TempDir dir;
  const std::string folder = dir / "abl";
  ExpectSuccess(
      Ablate(folder, {"--vary=terms=none,manhattan:1,manhattan:100"}));
  const auto rows = Results(folder);
  ASSERT_EQ(rows.size(), 3u);
  for (const auto& row : rows) {
    EXPECT_EQ(row.at("status"), "ok");
    EXPECT_EQ(row.at("comparable"), "yes");
    EXPECT_EQ(row.at("E_tex_initial"), rows[0].at("E_tex_initial"));
  }
  EXPECT_EQ(rows[1].at("terms"), "manhattan:1");
  EXPECT_GE(std::stod(rows[2].at("E_tex")), std::stod(rows[0].at("E_tex")));
  EXPECT_NE(rows[2].at("E_tex"), rows[0].at("E_tex"));
  EXPECT_NE(ReadFile(folder + "/table.md").find("manhattan:100"),
            std::string::npos);
  const Outcome refused = Ablate(dir / "no", {"--vary=terms=none,manhatten:1"});
  EXPECT_NE(refused.code, 0);
  EXPECT_NE(refused.err.find("manhattan"), std::string::npos) << refused.err;
}

// Starts facet-ablate and leaves it running.
pid_t StartAblation(const std::string& output,
                    const std::vector<std::string>& extra) {
  const std::string program = std::string(FACET_BIN_DIR) + "/facet-ablate";
  const std::vector<std::string> arguments = Arguments(output, extra);
  const pid_t child = fork();
  if (child != 0) return child;
  const int null = open("/dev/null", O_WRONLY);
  dup2(null, STDOUT_FILENO);
  dup2(null, STDERR_FILENO);
  std::vector<char*> argv = {const_cast<char*>(program.c_str())};
  for (const std::string& a : arguments) {
    argv.push_back(const_cast<char*>(a.c_str()));
  }
  argv.push_back(nullptr);
  alarm(100);
  execv(program.c_str(), argv.data());
  _exit(127);
}

// The folders of runs whose program has begun.
size_t RunsBegun(const std::string& folder) {
  size_t begun = 0;
  if (!fs::exists(folder + "/runs/scan")) return 0;
  for (const auto& entry : fs::directory_iterator(folder + "/runs/scan")) {
    begun += fs::exists(entry.path() / "log.txt") ? 1 : 0;
  }
  return begun;
}

// Killed while the second of two runs is under way: the first one is kept, the
// second one is not taken as done, and the same command ends with what an
// undisturbed one writes. Breaks if a mark is written before its run is whole.
TEST(CliAblate, GoesOnAfterAKill) {
  const TempDir dir;
  const std::string folder = dir / "abl";
  const std::vector<std::string> extra = {
      "--vary=schedule=1x[C; T],20x[C; Phi; T+F]"};
  const pid_t child = StartAblation(folder, extra);
  int status = 0;
  while (RunsBegun(folder) < 2) {
    ASSERT_EQ(waitpid(child, &status, WNOHANG), 0) << "it ended too early";
    usleep(5000);
  }
  kill(child, SIGKILL);
  waitpid(child, &status, 0);
  EXPECT_EQ(WTERMSIG(status), SIGKILL);
  const auto finished = FinishedRuns(folder);
  ASSERT_EQ(finished.size(), 1u);
  EXPECT_FALSE(fs::exists(folder + "/results.csv"));

  ExpectSuccess(Ablate(folder, extra));
  EXPECT_EQ(FinishedRuns(folder).size(), 2u);
  const std::string& kept = finished.begin()->first;
  EXPECT_EQ(FinishedRuns(folder).at(kept), finished.begin()->second);
  ExpectSuccess(Ablate(dir / "undisturbed", extra));
  const auto rows = Results(folder), expected = Results(dir / "undisturbed");
  ASSERT_EQ(rows.size(), 2u);
  for (size_t i = 0; i < 2; ++i) {
    for (const char* column : {"folder", "E_tex", "E_c", "rms_grey"}) {
      EXPECT_EQ(rows[i].at(column), expected[i].at(column)) << column;
    }
  }

  // A mark that was cut short, or is of another run, is none.
  for (const char* mark : {"{\"id\": \"", "{\"id\": \"0\"}"}) {
    WriteFileAtomically(kept, mark);
    ExpectSuccess(Ablate(folder, extra));
    EXPECT_TRUE(ReadJson(kept).contains("evaluation"));
  }
}

// Other texels: refused as soon as it shows, naming both; or kept apart.
TEST(CliAblate, OtherObservationsAreRefused) {
  const TempDir dir;
  const std::string vary = "--vary=texel_stride=1,2";
  ExpectRefused(Ablate(dir / "abl", {vary}),
                kExitOptions,
                {"texel_stride=1",
                 "texel_stride=2",
                 "observations",
                 "--allow_different_observations"});
  EXPECT_FALSE(fs::exists(dir / "abl/results.csv"));
  ExpectSuccess(Ablate(dir / "abl", {vary, "--allow_different_observations"}));
  const auto rows = Results(dir / "abl");
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].at("comparable"), "yes");
  EXPECT_EQ(rows[1].at("comparable"), "other observations");
}

TEST(CliAblate, RefusesWhatItCannotVary) {
  const TempDir dir;
  const auto vary = [&](const std::string& text) {
    return Ablate(dir / "abl", {"--vary=" + text});
  };
  ExpectRefused(
      vary("plan=raw4"), kExitOptions, {"'plan'", "plane", "schedule"});
  ExpectRefused(vary("plane=raw5"), kExitOptions, {"anchored, raw4", "^"});
  ExpectRefused(vary("plane=raw4; schedule=2x[C; X]"),
                kExitOptions,
                {"character 22", "C, Phi, T, F"});
  ExpectRefused(vary("lambda2=0.1,many"), kExitOptions, {"double"});
  ExpectRefused(vary("lambda2=0.1,-1"), kExitOptions, {"--lambda2", "greater"});
  ExpectRefused(vary("output=a,b"), kExitOptions, {"'output' cannot"});
  ExpectRefused(vary("noise_mm=1,2"), kExitOptions, {"--noise_mm"});
  ExpectRefused(vary("flags=a:{--lambda2=0.1},b:{--lambda2=0.10}"),
                kExitOptions,
                {"'a' and 'b'", "same settings"});
  ExpectRefused(vary("flags={--plane=none}"), kExitOptions, {"--plane"});
  // A value that changes what comes before the common state.
  ExpectRefused(vary("partition_clusters=80,90"),
                kExitOptions,
                {"target_clusters", "one state"});
  ExpectRefused(Ablate(dir / "abl", {"--vary=plane=raw4", "--design=all"}),
                kExitOptions,
                {"one_at_a_time"});
  ExpectRefused(
      RunProgram("ablate", {"--vary=plane=raw4"}), kExitOptions, {"--output"});
  ExpectRefused(
      RunProgram("ablate", {"--vary=plane=raw4", "--output=" + dir / "abl"}),
      kExitOptions,
      {"--scans"});
  ExpectNothingIn(dir.path());
}

TEST(CliAblate, ListsAndPlansWithoutRunning) {
  const TempDir dir;
  const Outcome list = RunProgram("ablate", {"--list"});
  ExpectSuccess(list);
  for (const char* line :
       {"plane = [anchored] raw4", "schedule =", "gauge ="}) {
    EXPECT_NE(list.out.find(line), std::string::npos) << line;
  }
  const Outcome plan =
      Ablate(dir / "abl",
             {"--dry_run",
              "--design=one_at_a_time",
              "--vary=plane=anchored,raw4; gauge=mean,prior,none"});
  ExpectSuccess(plan);
  EXPECT_NE(plan.out.find("4 variants of 1 scans: 4 runs"), std::string::npos)
      << plan.out;
  EXPECT_NE(plan.out.find("--gauge=prior"), std::string::npos);
  ExpectNothingIn(dir.path());
}

// Scans made on demand come with the truth; a scan that cannot be made fails
// its own runs only.
TEST(CliAblate, SyntheticScansHaveTruth) {
  const TempDir dir;
  WriteFileAtomically(dir / "empty.ply", "ply\n");
  WriteFileAtomically(dir / "scans.json",
                      "[{\"name\": \"broken\", \"sequence\": \"" +
                          Fixture("scan") + "\", \"mesh\": \"empty.ply\"}]");
  const Outcome outcome =
      RunProgram("ablate",
                 {"--flagfile=" + Fixture("small.flags"),
                  "--output=" + dir / "abl",
                  "--vary=schedule=1x[C; T]",
                  "--levels=1",
                  "--scans=" + dir / "scans.json",
                  "--synthetic_seeds=3",
                  "--noise_mm=4",
                  "--synthesize_flags=--frames=12 --width=120 --height=90",
                  "--fuse_flags=--voxel_size=0.08",
                  "--holdout_stride=6"},
                 110);
  ExpectRefused(outcome, kExitUnsolvable, {"1 of 2 runs failed"});
  const auto rows = Results(dir / "abl");
  ASSERT_EQ(rows.size(), 2u);
  EXPECT_EQ(rows[0].at("status"), "ok");
  EXPECT_EQ(rows[0].at("noise_mm"), "4");
  // 4 mm rms an axis, and 0.16 degrees.
  EXPECT_GT(std::stod(rows[0].at("ate_input_mm")), 2);
  EXPECT_LT(std::stod(rows[0].at("ate_input_mm")), 15);
  for (const char* column : {"ate_mm",
                             "rpe_frame_mm",
                             "plane_angle_deg",
                             "plane_offset_mm",
                             "psnr_aligned_db",
                             "gradient_ncc"}) {
    EXPECT_NE(rows[0].at(column), "") << column;
  }
  EXPECT_NE(rows[1].at("status").find("empty.ply"), std::string::npos);

  // Errors along the trace begin and end where the figures of the run do.
  const auto trace = ReadCsv(dir / "abl/trace.csv");
  ASSERT_EQ(trace.size(), 3u) << "the start and two phases";
  for (const char* column : {"plane_angle", "plane_offset"}) {
    const std::string unit =
        column == std::string("plane_angle") ? "_deg" : "_mm";
    const double first = std::stod(trace.front().at(column + unit));
    const double last = std::stod(trace.back().at(column + unit));
    EXPECT_NEAR(first, std::stod(rows[0].at(column + ("_input" + unit))), 1e-6);
    EXPECT_NEAR(last, std::stod(rows[0].at(column + unit)), 1e-6);
  }
  // Of the keyframes alone, which are but some of the frames.
  EXPECT_NEAR(std::stod(trace.front().at("ate_mm")),
              std::stod(rows[0].at("ate_input_mm")),
              0.5 * std::stod(rows[0].at("ate_input_mm")));
  EXPECT_NE(trace.front().at("ate_mm"), trace.back().at("ate_mm"));
  EXPECT_EQ(trace[1].at("ate_mm"), trace[0].at("ate_mm"))
      << "colours move no camera";
}

}  // namespace
}  // namespace facet
