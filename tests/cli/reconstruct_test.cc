// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// What facet-reconstruct writes, and that it writes the same again.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <sstream>

#include "mesh/mesh_io.h"
#include "rgbd/trajectory_io.h"
#include "tests/cli/cli_run.h"
#include "texture/model_io.h"
#include "util/atomic_file.h"

namespace facet {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

void ExpectSameModel(const std::string& a, const std::string& b) {
  for (const char* file :
       {"mesh.obj", "mesh.mtl", "planes.json", "poses.txt", "texture_0.png"}) {
    EXPECT_TRUE(ReadFile(a + "/" + file) == ReadFile(b + "/" + file))
        << file << " differs between " << a << " and " << b;
  }
}

// Every file that docs/formats.md promises, and no leftovers. The only test
// that draws previews.
TEST(CliReconstruct, RunFolderIsComplete) {
  const TempDir dir;
  ExpectSuccess(
      Reconstruct(dir / "run", {"--previews=true", "--simplify_faces=1000"}));
  for (const char* file : {"mesh.obj",
                           "mesh.mtl",
                           "texture_0.png",
                           "mesh.glb",
                           "partition.ply",
                           "simplified.ply",
                           "planes.json",
                           "poses.txt",
                           "trace.csv",
                           "flags.txt",
                           "report.json"}) {
    EXPECT_TRUE(fs::exists(dir / "run" + "/" + file)) << file;
  }
  std::map<std::string, int> pictures;
  for (const auto& entry : fs::directory_iterator(dir / "run/previews")) {
    const std::string name = entry.path().filename().string();
    ++pictures[name.substr(0, name.find('_'))];
    EXPECT_GT(fs::file_size(entry.path()), 5000u) << name;
  }
  for (const char* kind : {"input", "planes", "wireframe", "before", "after"}) {
    EXPECT_GE(pictures[kind], 3) << kind;
  }
  ExpectNoPartialFile(dir.path());
}

// The fields of report.json that scripts rely on.
TEST(CliReconstruct, ReportHasItsFields) {
  const json report = ReadJson(Fixture("run/report.json"));
  for (const char* pointer : {"/result/vertices",
                              "/result/faces",
                              "/result/planes",
                              "/keyframes",
                              "/texels",
                              "/observations",
                              "/slide/mm",
                              "/slide/deg",
                              "/mesh_checks/non_manifold_edges",
                              "/mesh_checks/duplicate_faces",
                              "/mesh_checks/degenerate_faces",
                              "/mesh_checks/flipped_faces",
                              "/versions/facet",
                              "/versions/ceres",
                              "/warnings"}) {
    EXPECT_TRUE(report.contains(json::json_pointer(pointer))) << pointer;
  }
  for (const char* when : {"initial", "final"}) {
    for (const char* term :
         {"E_c", "E_p", "E_s", "E_tex", "rms_grey", "clamped_share"}) {
      EXPECT_TRUE(report["energy"][when][term].is_number()) << when << term;
    }
  }
  EXPECT_LT(report["energy"]["final"]["E_tex"],
            report["energy"]["initial"]["E_tex"]);
  // One frozen set of observations.
  EXPECT_EQ(report["energy"]["final"]["observations"],
            report["energy"]["initial"]["observations"]);
  std::vector<std::string> names;
  for (const json& stage : report["stages"]) {
    names.push_back(stage["name"]);
    for (const char* number : {"wall_s", "cpu_s", "peak_rss_mb"}) {
      EXPECT_TRUE(stage[number].is_number()) << number;
    }
  }
  EXPECT_EQ(names,
            (std::vector<std::string>{"partition",
                                      "simplify",
                                      "keyframes",
                                      "photometric",
                                      "geometry",
                                      "export"}));
}

// All outputs agree with each other and with the report.
TEST(CliReconstruct, FilesAgree) {
  const std::string run = Fixture("run");
  const json report = ReadJson(run + "/report.json");
  const TexturedMesh model = LoadModel(run + "/mesh.obj");
  EXPECT_EQ(model.mesh.NumFaces(), report["result"]["faces"]);
  EXPECT_EQ(model.pages.size(), report["texture"]["pages"]);
  EXPECT_TRUE(HasColor(model));
  const TexturedMesh folder = LoadModel(run);
  EXPECT_EQ(folder.mesh.NumFaces(), model.mesh.NumFaces());

  const size_t planes = report["result"]["planes"];
  EXPECT_EQ(ReadJson(run + "/planes.json").size(), planes);
  for (const char* file : {"partition.ply", "simplified.ply"}) {
    const MeshFile mesh = ReadMesh(run + "/" + file);
    ASSERT_EQ(mesh.face_plane.size(), mesh.mesh.NumFaces()) << file;
    EXPECT_EQ(mesh.mesh.vertex_colors.size(), mesh.mesh.NumVertices()) << file;
    const auto [low, high] =
        std::minmax_element(mesh.face_plane.begin(), mesh.face_plane.end());
    EXPECT_GE(*low, 0) << file;
    EXPECT_LT(static_cast<size_t>(*high), planes) << file;
  }
  // All 24 frames, though every second one is a keyframe.
  EXPECT_EQ(ReadPoses(run + "/poses.txt").size(), 24u);
  EXPECT_EQ(report["keyframes"], 12);

  // A row for the start and one a phase: 2 x [C; Phi; T+F] on three levels.
  std::istringstream trace(ReadFile(run + "/trace.csv"));
  std::vector<std::string> rows;
  for (std::string row; std::getline(trace, row);) rows.push_back(row);
  ASSERT_EQ(rows.size(), 1u + 1u + 3u * 6u);
  for (const char* column : {"E_c",
                             "E_p",
                             "E_s",
                             "E_tex",
                             "rms_grey",
                             "observations",
                             "accepted",
                             "wall_s"}) {
    EXPECT_NE(rows[0].find(column), std::string::npos) << rows[0];
  }
}

// Held-out frames leave no trace in the keyframes but get a pose.
TEST(CliReconstruct, HeldOutFramesAreNotUsed) {
  const TempDir dir;
  ExpectSuccess(Reconstruct(
      dir / "run",
      {"--keyframe_window=1", "--holdout_stride=4", "--holdout_offset=3"}));
  const json report = ReadJson(dir / "run/report.json");
  EXPECT_EQ(report["keyframes"], 18);
  EXPECT_EQ(report["keyframe_selection"]["held_out"], 6);
  EXPECT_EQ(ReadPoses(dir / "run/poses.txt").size(), 24u);
}

TEST(CliReconstruct, TwoRunsAndAnyNumberOfThreadsAgree) {
  const TempDir dir;
  ExpectSuccess(Reconstruct(dir / "one", {"--threads=1"}));
  ExpectSuccess(Reconstruct(dir / "two", {"--threads=2"}));
  ExpectSuccess(Reconstruct(dir / "again", {"--threads=2"}));
  ExpectSameModel(dir / "one", dir / "two");
  ExpectSameModel(dir / "two", dir / "again");
  ExpectSameModel(dir / "one", Fixture("run"));
}

// Breaks if where images are held shows in any result. A limit just below what
// the plan expects puts them into a file.
TEST(CliReconstruct, ImagesInAFileChangeNothing) {
  const TempDir dir;
  const std::string every = "--keyframe_window=1";
  ExpectSuccess(Reconstruct(dir / "memory", {every}));
  const json before = ReadJson(dir / "memory/report.json")["memory"];
  EXPECT_EQ(before["images"], "memory");
  const double limit_gb = (before["estimate_mb"].get<double>() - 0.1) / 1024;
  for (const char* threads : {"1", "3"}) {
    const std::string run = dir / threads;
    ExpectSuccess(Reconstruct(run,
                              {every,
                               std::string("--threads=") + threads,
                               "--max_memory_gb=" + std::to_string(limit_gb)}));
    const json memory = ReadJson(run + "/report.json")["memory"];
    EXPECT_EQ(memory["images"], "file");
    EXPECT_GT(memory["file_mb"], 0);
    ExpectSameModel(run, dir / "memory");
    ExpectNoPartialFile(run);
  }
}

// flags.txt alone brings the run back, also when it holds a profile.
TEST(CliReconstruct, FlagsFileReproducesTheRun) {
  const TempDir dir;
  ExpectSuccess(RunProgram(
      "reconstruct",
      {"--flagfile=" + Fixture("run/flags.txt"), "--output=" + dir / "again"}));
  ExpectSameModel(dir / "again", Fixture("run"));

  ExpectSuccess(Reconstruct(dir / "paper",
                            {"--profile=paper", "--bake_robust_luma=0.5"}));
  ExpectSuccess(RunProgram(
      "reconstruct",
      {"--flagfile=" + dir / "paper/flags.txt", "--output=" + dir / "paper2"}));
  ExpectSameModel(dir / "paper", dir / "paper2");
  EXPECT_FALSE(ReadFile(dir / "paper/mesh.obj") ==
               ReadFile(Fixture("run/mesh.obj")));
}

// The profile replaces defaults only, wherever the user's own flags stand.
TEST(CliReconstruct, UserFlagsWinOverTheProfile) {
  const TempDir dir;
  WriteFileAtomically(dir / "mine.flags",
                      "--gauge_sigma_mm=7\n--profile=paper\n--lambda2=0.3\n");
  const auto options = [&](const std::vector<std::string>& flags) {
    static int count = 0;
    const std::string run = dir / ("run" + std::to_string(count++));
    std::vector<std::string> all = flags;
    all.push_back("--to_stage=partition");
    ExpectSuccess(Reconstruct(run, all));
    return ReadJson(run + "/report.json")["options"]["photometric"];
  };
  const json paper = options({"--profile=paper"});
  EXPECT_EQ(paper["lambda2"], 0.1);
  EXPECT_EQ(paper["pose_prior"], false);
  EXPECT_EQ(paper["smoothing_sigma_px"], 0);
  EXPECT_EQ(paper["schedule"], "2x[C; Phi; T+F]");  // of small.flags
  EXPECT_EQ(options({"--gauge=prior", "--profile=paper"})["pose_prior"], true);
  EXPECT_EQ(options({"--profile", "paper", "--gauge=prior"})["pose_prior"],
            true);
  const json file = options({"--flagfile=" + dir / "mine.flags"});
  EXPECT_EQ(file["lambda2"], 0.3);
  EXPECT_EQ(file["pose_prior"], false);
}

// With --overwrite nothing of a larger earlier model stays behind.
TEST(CliReconstruct, OverwriteLeavesNothingStale) {
  const TempDir dir;
  WriteFileAtomically(dir / "run/texture_1.png", "of an earlier run");
  WriteFileAtomically(dir / "run/report.json", "of an earlier run");
  ExpectSuccess(Reconstruct(dir / "run", {"--overwrite"}));
  EXPECT_FALSE(fs::exists(dir / "run/texture_1.png"));
  ExpectSameModel(dir / "run", Fixture("run"));
}

// The model of pipeline/preflight.h is right within a factor of a few even
// where constants dominate.
TEST(CliReconstruct, MemoryEstimateIsHonest) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the sanitizer takes memory of its own";
#endif
  const json report = ReadJson(Fixture("run/report.json"));
  double peak = 0;
  for (const json& stage : report["stages"]) {
    peak = std::max(peak, stage["peak_rss_mb"].get<double>());
  }
  const double estimate = report["memory"]["estimate_mb"];
  EXPECT_GT(estimate, 0.3 * peak);
  EXPECT_LT(estimate, 5 * peak);
  EXPECT_GT(report["memory"]["available_mb"], 0);
}

// Stages announce themselves on stdout while they run, one line each.
TEST(CliReconstruct, SaysWhatItDoes) {
  const TempDir dir;
  const Outcome outcome = Reconstruct(dir / "run");
  ExpectSuccess(outcome);
  for (const char* stage : {"plan ",
                            "partition ",
                            "simplify ",
                            "keyframes ",
                            "photometric ",
                            "geometry ",
                            "export "}) {
    EXPECT_NE(("\n" + outcome.out).find(std::string("\n") + stage),
              std::string::npos)
        << stage;
  }
  EXPECT_EQ(outcome.err.find("%"), std::string::npos)
      << "a progress bar in a file: " << outcome.err;
}

}  // namespace
}  // namespace facet
