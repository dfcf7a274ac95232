// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Options that make no sense end before the work starts: exit code 2, one
// sentence that names the flag, and nothing written.
#include <gtest/gtest.h>

#include <fstream>

#include "tests/cli/cli_run.h"
#include "util/atomic_file.h"
#include "util/errors.h"

namespace facet {
namespace {

// `flag` is refused naming it and `words`, with nothing written.
void ExpectOptionRefused(const std::string& flag,
                         std::vector<std::string> words = {}) {
  const TempDir dir;
  words.push_back(flag.substr(0, flag.find('=')));
  ExpectRefused(Reconstruct(dir / "run", {flag}), kExitOptions, words);
  ExpectNothingIn(dir.path());
}

// Breaks if a flag without which nothing can be done is first missed when its
// value is used.
TEST(CliOptions, MissingFlagsAreNamed) {
  const TempDir dir;
  for (const std::string missing : {"sequence", "mesh", "output"}) {
    ExpectRefused(Reconstruct(dir / "run", {"--" + missing + "="}),
                  kExitOptions,
                  {"--" + missing});
  }
  ExpectRefused(RunProgram("fuse", {"--sequence=" + Fixture("scan")}),
                kExitOptions,
                {"--output"});
  ExpectRefused(RunProgram("fuse", {"--output=" + dir / "mesh.ply"}),
                kExitOptions,
                {"--sequence"});
  ExpectRefused(RunProgram("synthesize", {}), kExitOptions, {"--output"});
  ExpectRefused(RunProgram("evaluate", {}), kExitOptions, {"--model"});
  ExpectRefused(RunProgram("check-input", {}), kExitOptions, {"--mesh"});
  ExpectNothingIn(dir.path());
}

// Breaks if a number out of range is noticed by the stage that uses it, when
// the stages before have run for minutes, or never.
TEST(CliOptions, NumbersOutOfRange) {
  for (const char* flag : {"--partition_clusters=0",
                           "--partition_max_rms=-1",
                           "--merge_max_normal_deg=0",
                           "--merge_min_sheet_deg=90",
                           "--simplify_faces=-1",
                           "--simplify_border_ratio=0",
                           "--simplify_passes=0",
                           "--texel_size=0",
                           "--texel_size=nan",
                           "--atlas_page_size=0",
                           "--texel_stride=-1",
                           "--max_angle_deg=90",
                           "--min_views=1",
                           "--stop_decrease=nan",
                           "--smoothing=-1",
                           "--warp_columns=1",
                           "--warp_rows=1000",
                           "--lambda2=0",
                           "--lambda2=nan",
                           "--gauge_sigma_mm=0",
                           "--pose_iterations=0",
                           "--active_tolerance=-1",
                           "--active_tolerance=nan",
                           "--lambda3=-1",
                           "--geometry_iterations=0",
                           "--geometry_band=0",
                           "--bake_angle_power=-1",
                           "--bake_best_view_power=0",
                           "--bake_robust_luma=-1",
                           "--keyframe_window=0",
                           "--holdout_stride=-1",
                           "--threads=-1"}) {
    ExpectOptionRefused(flag);
  }
  ExpectOptionRefused("--min_depth=7", {"max_depth"});
}

// The message lists what is possible.
TEST(CliOptions, UnknownChoices) {
  ExpectOptionRefused("--gauge=glue", {"prior", "none"});
  ExpectOptionRefused("--plane=round", {"anchored", "raw4"});
  ExpectOptionRefused("--simplify_stop=never", {"budget", "counts"});
  ExpectOptionRefused("--plane_init=guess", {"dense", "simplified"});
  ExpectOptionRefused("--geometry_freedom=all", {"band", "none"});
  ExpectOptionRefused("--bake_sampler=lanczos", {"bilinear", "bicubic"});
  ExpectOptionRefused("--pose_camera=left", {"depth", "color"});
  ExpectOptionRefused("--extrinsic_direction=up", {"rig_to_cam", "cam_to_rig"});
  ExpectOptionRefused("--profile=fast", {"default", "paper"});
  ExpectOptionRefused("--from_stage=magic", {"partition", "export"});
  ExpectOptionRefused("--to_stage=magic", {"partition", "export"});
}

// Breaks if a schedule is read when its turn comes, or an error in it cannot be
// found.
TEST(CliOptions, SchedulesAreReadFirst) {
  ExpectOptionRefused("--schedule=3x[C; Q]", {"character 7", "C, Phi, T, F"});
  ExpectOptionRefused("--schedule=", {"character 1"});
  ExpectOptionRefused("--schedule=0x[C]", {"positive"});
  // Blocks that no solver takes together.
  ExpectOptionRefused("--schedule=C; Phi; 2x[C+F]", {"C+F"});
  ExpectOptionRefused("--schedule=Phi+T", {"Phi+T"});
}

TEST(CliOptions, StagesInTheWrongOrder) {
  const TempDir dir;
  ExpectRefused(
      Reconstruct(dir / "run", {"--from_stage=export", "--to_stage=simplify"}),
      kExitOptions,
      {"--from_stage", "--to_stage"});
  ExpectNothingIn(dir.path());
}

// A typing error must not be taken for silence.
TEST(CliOptions, UnknownFlagsAndValues) {
  for (const char* program :
       {"synthesize", "fuse", "reconstruct", "evaluate", "check-input"}) {
    const Outcome outcome = RunProgram(program, {"--no_such_flag=1"});
    EXPECT_EQ(outcome.code, kExitInternal) << outcome.command;
    EXPECT_NE(outcome.err.find("no_such_flag"), std::string::npos);
  }
  const Outcome value = RunProgram("reconstruct", {"--texel_size=big"});
  EXPECT_EQ(value.code, kExitInternal);
  EXPECT_NE(value.err.find("texel_size"), std::string::npos);
  ExpectRefused(RunProgram("reconstruct", {"scan"}), kExitOptions, {"'scan'"});
}

// gflags itself skips what it does not know in a flag file.
TEST(CliOptions, UnknownFlagsInFlagFiles) {
  const TempDir dir;
  WriteFileAtomically(dir / "typo.flags",
                      "# a comment\n\n--notest_angle\n--texel_sise=0.01\n");
  ExpectRefused(RunProgram("reconstruct", {"--flagfile=" + dir / "typo.flags"}),
                kExitOptions,
                {dir / "typo.flags", "line 4", "'texel_sise'"});
  ExpectRefused(Reconstruct(dir / "run", {"--flagfile", dir / "typo.flags"}),
                kExitOptions,
                {"line 4"});
  WriteFileAtomically(dir / "value.flags", "--texel_size=big\n");
  const Outcome value =
      Reconstruct(dir / "run", {"--flagfile=" + dir / "value.flags"});
  EXPECT_EQ(value.code, kExitInternal);
  EXPECT_NE(value.err.find("texel_size"), std::string::npos);
  const Outcome missing =
      Reconstruct(dir / "run", {"--flagfile=" + dir / "none.flags"});
  EXPECT_EQ(missing.code, kExitInternal);
  EXPECT_NE(missing.err.find(dir / "none.flags"), std::string::npos);
  ExpectNothingIn(dir / "run");
}

// A finished run is never overwritten by accident, and stays whole.
TEST(CliOptions, FullOutputFolder) {
  const TempDir dir;
  WriteFileAtomically(dir / "run/mesh.obj", "precious");
  ExpectRefused(Reconstruct(dir / "run"),
                kExitOptions,
                {dir / "run", "not empty", "--overwrite"});
  EXPECT_EQ(ReadFile(dir / "run/mesh.obj"), "precious");
  EXPECT_FALSE(std::filesystem::exists(dir / "run/flags.txt"));
  ExpectRefused(RunProgram("synthesize", {"--output=" + dir / "run"}),
                kExitOptions,
                {dir / "run", "--overwrite"});
}

// Also root cannot write below a file.
TEST(CliOptions, OutputCannotBeWritten) {
  const TempDir dir;
  WriteFileAtomically(dir / "file", "a file");
  const Outcome below = Reconstruct(dir / "file/run");
  ExpectRefused(below, kExitInput, {dir / "file/run"});
  ExpectRefused(Reconstruct(dir / "file"), kExitOptions, {dir / "file"});
  ExpectRefused(RunProgram("fuse",
                           {"--sequence=" + Fixture("scan"),
                            "--voxel_size=0.1",
                            "--output=" + dir / "file/mesh.ply"}),
                kExitInput,
                {dir / "file"});
  ExpectRefused(RunProgram("evaluate",
                           {"--sequence=" + Fixture("scan"),
                            "--frames=3",
                            "--model=" + Fixture("run"),
                            "--dump_images=" + dir / "file/images"}),
                kExitInput,
                {"--dump_images", dir / "file"});
  ExpectRefused(RunProgram("evaluate",
                           {"--sequence=" + Fixture("scan"),
                            "--frames=3",
                            "--model=" + Fixture("run"),
                            "--output=" + dir / "file/report.json"}),
                kExitInput,
                {dir / "file"});
  EXPECT_EQ(ReadFile(dir / "file"), "a file");
}

}  // namespace
}  // namespace facet
