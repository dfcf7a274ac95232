// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Going on from a stage gives what one go gives, bit for bit, and is refused
// when options of the stages before have changed.
#include <gtest/gtest.h>

#include <filesystem>

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
  scan.Write(scan.FrameFile(4, "pose.txt"), "-inf");
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
  EXPECT_EQ(in_one_go.size(), 3u) << in_one_go;
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

// Changing an option of a stage that is not run again is refused, naming it and
// the stage to start from; the folder stays as it is. Breaks if an option is
// forgotten in StageSettings.
TEST(CliResume, OtherOptionsAreRefused) {
  const RunCopy run;
  const std::string flags = ReadFile(run.path() + "/flags.txt");
  const struct {
    const char *flag, *option, *stage;
  } kCases[] = {
      {"--partition_clusters=81", "partition.target_clusters", "partition"},
      {"--merge_max_normal_deg=9", "partition.max_normal_deg", "partition"},
      {"--merge_islands=false", "partition.absorb_islands", "partition"},
      {"--simplify_faces=1900", "simplify.target_faces", "simplify"},
      {"--simplify_stop=counts", "simplify.stop", "simplify"},
      {"--keyframe_window=3", "keyframes.window", "keyframes"},
      {"--holdout_stride=5", "keyframes.holdout_stride", "keyframes"},
      {"--max_depth=5", "keyframes.max_depth_m", "keyframes"},
      {"--pose_camera=color", "keyframes.pose_camera", "keyframes"},
      {"--texel_size=0.03", "photometric.texel_size_m", "photometric"},
      {"--schedule=C", "photometric.schedule", "photometric"},
      {"--gauge=none", "photometric.", "photometric"},
      {"--lambda2=0.2", "photometric.lambda2", "photometric"},
      {"--smoothing=0.5", "photometric.smoothing_sigma_px", "photometric"},
      {"--test_angle=false", "photometric.test_angle", "photometric"},
      {"--plane_init=simplified", "photometric.plane_init", "photometric"},
      {"--lambda3=2", "geometry.lambda3", "geometry"},
      {"--geometry_freedom=none", "geometry.freedom", "geometry"},
      {"--geometry_band=0.01", "geometry.band_m", "geometry"},
  };
  for (const auto& c : kCases) {
    ExpectRefused(Reconstruct(run.path(), {"--from_stage=export", c.flag}),
                  kExitOptions,
                  {c.option, std::string("--from_stage=") + c.stage});
  }
  EXPECT_EQ(ReadFile(run.path() + "/flags.txt"), flags);
  EXPECT_TRUE(fs::exists(run.path() + "/report.json"));
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
