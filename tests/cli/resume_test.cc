// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Going on from a stage gives what one go gives, bit for bit, and is refused
// when options of the stages before have changed.
#include <gflags/gflags.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <set>

#include "apps/flags/reconstruct.h"
#include "mesh/mesh_io.h"
#include "tests/cli/cli_run.h"
#include "util/atomic_file.h"
#include "util/errors.h"

namespace facet {
namespace {

namespace fs = std::filesystem;

const char* const kStages[] = {
    "partition", "simplify", "keyframes", "photometric", "geometry", "export"};

void ExpectSameModel(const std::string& run_folder) {
  for (const char* file : {"mesh.obj", "planes.json", "poses.txt"}) {
    EXPECT_TRUE(ReadFile(run_folder + "/" + file) ==
                ReadFile(Fixture("run") + "/" + file))
        << file << " differs in " << run_folder;
  }
}

// A copy of the fixture's finished run.
class RunCopy {
 public:
  RunCopy() { fs::copy(Fixture("run"), path(), fs::copy_options::recursive); }
  std::string path() const { return dir_ / "run"; }

 private:
  TempDir dir_;
};

// Breaks if an artefact loses bits, or a stage depends on what an earlier one
// left in memory.
TEST(CliResume, EveryStageGivesTheSameModel) {
  const RunCopy run;
  for (const char* stage : kStages) {
    for (const char* file : {"mesh.obj", "planes.json", "poses.txt"}) {
      fs::remove(run.path() + "/" + file);
    }
    const Outcome outcome = Reconstruct(
        run.path(), {std::string("--from_stage=") + stage, "--overwrite"});
    ExpectSuccess(outcome);
    ExpectSameModel(run.path());
  }
}

// One stage a call, each in a process of its own.
TEST(CliResume, StageByStage) {
  const TempDir dir;
  for (const char* stage : kStages) {
    ExpectSuccess(Reconstruct(dir / "run",
                              {std::string("--from_stage=") + stage,
                               std::string("--to_stage=") + stage}));
    const bool last = stage == std::string("export");
    EXPECT_EQ(fs::exists(dir / "run/mesh.obj"), last) << stage;
  }
  ExpectSameModel(dir / "run");
  const nlohmann::json report = ReadJson(dir / "run/report.json");
  EXPECT_EQ(report["energy"], ReadJson(Fixture("run/report.json"))["energy"]);
}

// Breaks if what a stage had to say is lost when its result is used again, or
// said twice. Warnings: of the scan when it is opened, of partition (the mesh)
// and of keyframes (an image that does not decode).
TEST(CliResume, WarningsOfEarlierStagesStay) {
  const ScanCopy scan;
  scan.Write(scan.FrameFile(3, "color.jpg"), "not a picture");
  scan.Write(scan.FrameFile(4, "pose.txt"),
             "-inf -inf -inf -inf\n-inf -inf -inf -inf\n"
             "-inf -inf -inf -inf\n-inf -inf -inf -inf\n");
  TriMesh mesh = ReadMesh(Fixture("dense.ply")).mesh;
  mesh.faces.push_back(mesh.faces[0]);
  const TempDir dir;
  WritePly(dir / "bad.ply", mesh);
  const std::vector<std::string> flags = {"--sequence=" + scan.path(),
                                          "--mesh=" + dir / "bad.ply",
                                          "--keyframe_window=1"};
  ExpectSuccess(Reconstruct(dir / "run", flags));
  const auto warnings = [&] {
    return ReadJson(dir / "run/report.json")["warnings"];
  };
  const nlohmann::json in_one_go = warnings();
  for (const char* words : {"lost pose", "duplicate", "000003.color.jpg"}) {
    EXPECT_NE(in_one_go.dump().find(words), std::string::npos) << words;
  }
  for (const char* stage : kStages) {
    std::vector<std::string> resume = flags;
    resume.push_back(std::string("--from_stage=") + stage);
    resume.push_back("--overwrite");
    ExpectSuccess(Reconstruct(dir / "run", resume));
    EXPECT_EQ(warnings(), in_one_go) << stage;
  }
}

// flags.txt of a resumed run makes the same model elsewhere, in one go.
TEST(CliResume, FlagsFileOfAResumedRun) {
  const RunCopy run;
  ExpectSuccess(Reconstruct(run.path(), {"--from_stage=export"}));
  const TempDir dir;
  ExpectSuccess(RunProgram("reconstruct",
                           {"--flagfile=" + run.path() + "/flags.txt",
                            "--output=" + dir / "again"}));
  ExpectSameModel(dir / "again");
}

// Changing an option of a stage that is not run again is refused, naming the
// flag, both values and the stage to start from; the folder stays as it is.
// Breaks if an option is forgotten in StageSettings.
TEST(CliResume, OtherOptionsAreRefused) {
  const RunCopy run;
  const std::string flags = ReadFile(run.path() + "/flags.txt");
  const struct {
    const char *flag, *value, *old_value, *stage;
  } kCases[] = {
      {"partition_clusters", "81", "80", "partition"},
      {"merge_max_normal_deg", "9", "8", "partition"},
      {"merge_max_rms", "0", "0.03", "partition"},
      {"merge_islands", "false", "true", "partition"},
      {"simplify_faces", "1900", "2000", "simplify"},
      {"simplify_stop", "counts", "budget", "simplify"},
      {"keyframe_window", "3", "2", "keyframes"},
      {"holdout_stride", "5", "0", "keyframes"},
      {"max_depth", "5", "6", "keyframes"},
      {"pose_camera", "color", "depth", "keyframes"},
      {"texel_size", "0.03", "0.02", "photometric"},
      {"schedule", "C", "2x[C; Phi; T+F]", "photometric"},
      {"gauge", "none", "mean", "photometric"},
      {"gauge_sigma_deg", "0.4", "0.3", "photometric"},
      {"lambda2", "0.2", "0.1", "photometric"},
      {"smoothing", "0.5", "0.8", "photometric"},
      {"test_angle", "false", "true", "photometric"},
      {"plane_init", "simplified", "dense", "photometric"},
      {"lambda3", "2", "1", "geometry"},
      {"geometry_freedom", "none", "band", "geometry"},
      {"geometry_band", "0.02", "0.01", "geometry"},
  };
  for (const auto& c : kCases) {
    const std::string flag = std::string("--") + c.flag + "=";
    ExpectRefused(
        Reconstruct(run.path(), {"--from_stage=export", flag + c.value}),
        kExitOptions,
        {"with " + flag + c.old_value,
         "now it is " + flag + c.value,
         std::string("--from_stage=") + c.stage});
  }
  EXPECT_EQ(ReadFile(run.path() + "/flags.txt"), flags);
  EXPECT_TRUE(fs::exists(run.path() + "/report.json"));
}

// Breaks if a setting is renamed, or a new one added, whose flag the message
// above would not name.
TEST(CliResume, SettingsHaveFlags) {
  EXPECT_EQ(ProfileFlags("default"), "");  // links the flags in
  const std::set<std::string> without = {"weld_tolerance_m",
                                         "min_component_faces",
                                         "energy",
                                         "alpha",
                                         "tau",
                                         "swap_borders",
                                         "free_error_m",
                                         "max_error_m",
                                         "collapse_to_border",
                                         "keep_mesh_boundary",
                                         "min_depth_tolerance_m",
                                         "max_move_m"};
  for (int s = 0; s < static_cast<int>(Stage::kExport); ++s) {
    const auto settings = StageSettings({}, static_cast<Stage>(s));
    for (const auto& [name, value] : settings.items()) {
      gflags::CommandLineFlagInfo info;
      EXPECT_NE(
          gflags::GetCommandLineFlagInfo(FlagOfSetting(name).c_str(), &info),
          without.count(name) > 0)
          << name;
    }
  }
}

// The stage that the message names does take the new option.
TEST(CliResume, LaterOptionsMayChange) {
  const RunCopy run;
  ExpectSuccess(Reconstruct(
      run.path(), {"--from_stage=geometry", "--geometry_freedom=none"}));
  EXPECT_FALSE(ReadFile(run.path() + "/mesh.obj") ==
               ReadFile(Fixture("run/mesh.obj")));
  ExpectSuccess(Reconstruct(run.path(),
                            {"--from_stage=export",
                             "--bake_robust_luma=0.1",
                             "--geometry_freedom=none"}));
}

TEST(CliResume, MissingAndDamagedArtefacts) {
  const RunCopy run;
  const std::string file = run.path() + "/stages/simplify.bin";
  fs::resize_file(file, fs::file_size(file) / 2);
  ExpectRefused(Reconstruct(run.path(), {"--from_stage=geometry"}),
                kExitInput,
                {file, "damaged"});
  fs::remove(file);
  ExpectRefused(Reconstruct(run.path(), {"--from_stage=geometry"}),
                kExitInput,
                {file, "--from_stage=simplify"});
  const TempDir dir;
  ExpectRefused(Reconstruct(dir / "run", {"--from_stage=geometry"}),
                kExitInput,
                {"partition.bin", "--from_stage=partition"});
  ExpectNothingIn(dir.path());
}

}  // namespace
}  // namespace facet
