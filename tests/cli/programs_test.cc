// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The other programs, and what all have in common.
#include <gtest/gtest.h>

#include <filesystem>

#include "mesh/mesh_io.h"
#include "tests/cli/cli_run.h"
#include "util/atomic_file.h"
#include "util/errors.h"

namespace facet {
namespace {

// Also without any other flag, and though a profile is asked for.
TEST(CliPrograms, HelpListsTheFlags) {
  const struct {
    const char *program, *flag;
  } kPrograms[] = {{"synthesize", "pose_noise_mm"},
                   {"fuse", "voxel_size"},
                   {"reconstruct", "schedule"},
                   {"evaluate", "reference_mesh"},
                   {"check-input", "pose_camera"},
                   {"ablate", "vary"}};
  for (const auto& p : kPrograms) {
    const Outcome help = RunProgram(p.program, {"--help"});
    ExpectSuccess(help);
    EXPECT_NE(help.out.find(std::string("-") + p.flag), std::string::npos)
        << p.program;
    EXPECT_NE(help.out.find(std::string("facet-") + p.program),
              std::string::npos);
    EXPECT_EQ(help.out.find("-logtostderr"), std::string::npos)
        << "flags of libraries are noise";
    const Outcome version = RunProgram(p.program, {"--version"});
    ExpectSuccess(version);
    EXPECT_NE(version.out.find("0."), std::string::npos);
  }
  ExpectSuccess(RunProgram("reconstruct", {"--profile=paper", "--help"}));
}

// The true poses are those of the pose files (no noise was asked for), so the
// run must not be far from them.
TEST(CliPrograms, EvaluateKnowsARun) {
  const TempDir dir;
  const std::string scan = Fixture("scan");
  const Outcome outcome =
      RunProgram("evaluate",
                 {"--model=" + Fixture("run") + "," + Fixture("dense.ply"),
                  "--sequence=" + scan,
                  "--frames=3,11,19",
                  "--reference_mesh=" + scan + "/mesh_true.ply",
                  "--num_points=5000",
                  "--true_poses=" + scan + "/poses_true.txt",
                  "--true_planes=" + scan + "/planes_true.json",
                  "--true_mesh=" + scan + "/mesh_true.ply",
                  "--output=" + dir / "evaluation.json"});
  ExpectSuccess(outcome);
  for (const char* title : {"Photos",
                            "Poses against the truth",
                            "Planes against the truth",
                            "Distance"}) {
    EXPECT_NE(outcome.out.find(title), std::string::npos) << title;
  }
  const nlohmann::json json = ReadJson(dir / "evaluation.json");
  EXPECT_FALSE(json.empty());
  EXPECT_NE(json.dump().find("psnr"), std::string::npos);
}

TEST(CliPrograms, EvaluateRefusesWhatItCannotRead) {
  const TempDir dir;
  WriteFileAtomically(dir / "poses.txt", "0 1 2 3\n");
  WriteFileAtomically(dir / "planes.json", "{");
  const std::string scan = Fixture("scan");
  const std::vector<std::string> good = {
      "--model=" + Fixture("run"), "--sequence=" + scan, "--frames=3"};
  const auto with = [&](std::vector<std::string> extra) {
    extra.insert(extra.begin(), good.begin(), good.end());
    return RunProgram("evaluate", extra);
  };
  ExpectRefused(with({"--true_poses=" + dir / "poses.txt"}),
                kExitInput,
                {dir / "poses.txt"});
  ExpectRefused(with({"--true_planes=" + dir / "planes.json",
                      "--true_mesh=" + scan + "/mesh_true.ply"}),
                kExitInput,
                {dir / "planes.json"});
  ExpectRefused(with({"--true_planes=" + scan + "/planes_true.json",
                      "--true_mesh=" + Fixture("dense.ply")}),
                kExitInput,
                {"dense.ply", "plane_id"});
  ExpectRefused(with({"--true_mesh=" + scan + "/mesh_true.ply"}),
                kExitOptions,
                {"--true_planes"});
  ExpectRefused(with({"--frames=1000"}), kExitOptions, {"--frames"});
  ExpectRefused(with({"--frames=one"}), kExitOptions, {"'one'"});
  ExpectRefused(with({"--reference_mesh=" + dir / "none.ply"}),
                kExitInput,
                {dir / "none.ply"});
  std::filesystem::create_directory(dir / "no_run");
  ExpectRefused(
      with({"--model=" + dir / "no_run"}), kExitInput, {dir / "no_run"});
}

// The same seed gives the same mesh, on one thread and on two.
TEST(CliPrograms, FusionIsRepeatable) {
  const TempDir dir;
  for (const char* threads : {"1", "2"}) {
    ExpectSuccess(
        RunProgram("fuse",
                   {"--sequence=" + Fixture("scan"),
                    "--voxel_size=0.08",
                    std::string("--threads=") + threads,
                    "--output=" + dir / (std::string(threads) + ".ply")}));
  }
  EXPECT_TRUE(ReadFile(dir / "1.ply") == ReadFile(Fixture("dense.ply")));
  EXPECT_TRUE(ReadFile(dir / "2.ply") == ReadFile(Fixture("dense.ply")));
}

TEST(CliPrograms, FuseRefusesNonsense) {
  const TempDir dir;
  const auto fuse = [&](const std::string& flag) {
    return RunProgram("fuse",
                      {"--sequence=" + Fixture("scan"),
                       "--output=" + dir / "dense.ply",
                       flag});
  };
  ExpectRefused(fuse("--voxel_size=0"), kExitOptions, {"--voxel_size"});
  ExpectRefused(fuse("--voxel_size=nan"), kExitOptions, {"--voxel_size"});
  ExpectRefused(fuse("--frame_step=0"), kExitOptions, {"--frame_step"});
  ExpectRefused(
      fuse("--sdf_truncation=0.001"), kExitOptions, {"--sdf_truncation"});
  ExpectRefused(fuse("--holdout_stride=1"),
                kExitUnsolvable,
                {"no frame", "--holdout_stride"});
  ExpectRefused(
      fuse("--poses=" + dir / "none.txt"), kExitInput, {dir / "none.txt"});
  ExpectNothingIn(dir.path());
}

TEST(CliPrograms, SynthesizeRefusesNonsense) {
  const TempDir dir;
  for (const char* flag : {"--frames=0",
                           "--width=0",
                           "--height=-3",
                           "--pose_noise_mm=-1",
                           "--color_noise_grey=nan"}) {
    ExpectRefused(RunProgram("synthesize", {"--output=" + dir / "scan", flag}),
                  kExitOptions,
                  {});
  }
  ExpectNothingIn(dir / "scan");
}

}  // namespace
}  // namespace facet
