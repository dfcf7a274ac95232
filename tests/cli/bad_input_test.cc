// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Bad input ends in one sentence and a documented exit code, or in a counted
// warning and a good model: never in an abort, a hang or a black model.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <limits>

#include "mesh/mesh_io.h"
#include "tests/cli/cli_run.h"
#include "util/atomic_file.h"
#include "util/errors.h"

namespace facet {
namespace {

TriMesh DenseMesh() { return ReadMesh(Fixture("dense.ply")).mesh; }

// Runs on `mesh`, whose file is kept in `dir`.
Outcome ReconstructMesh(const TempDir& dir, const TriMesh& mesh) {
  WritePly(dir / "bad.ply", mesh);
  return Reconstruct(dir / "run", {"--mesh=" + dir / "bad.ply"});
}

void ExpectCleanResult(const std::string& run_folder) {
  const nlohmann::json report = ReadJson(run_folder + "/report.json");
  for (const char* check :
       {"non_manifold_edges", "duplicate_faces", "degenerate_faces"}) {
    EXPECT_EQ(report["mesh_checks"][check], 0) << check;
  }
  EXPECT_GT(report["result"]["faces"], 1000);
  EXPECT_GT(report["texture"]["texels_seen"], 10000);
}

TEST(CliBadInput, MissingFiles) {
  const TempDir dir;
  ExpectRefused(Reconstruct(dir / "run", {"--sequence=" + dir / "nowhere"}),
                kExitInput,
                {dir / "nowhere"});
  ExpectRefused(Reconstruct(dir / "run", {"--mesh=" + dir / "nothing.ply"}),
                kExitInput,
                {dir / "nothing.ply"});
  ExpectRefused(RunProgram("fuse",
                           {"--sequence=" + dir / "nowhere",
                            "--output=" + dir / "run/dense.ply"}),
                kExitInput,
                {dir / "nowhere"});
  ExpectRefused(RunProgram("check-input",
                           {"--sequence=" + Fixture("scan"),
                            "--mesh=" + dir / "nothing.ply"}),
                kExitInput,
                {dir / "nothing.ply"});
  ExpectRefused(RunProgram("evaluate",
                           {"--sequence=" + Fixture("scan"),
                            "--model=" + dir / "nothing.ply"}),
                kExitInput,
                {dir / "nothing.ply"});
  ExpectNothingIn(dir.path());
}

// A folder of that name, another kind of file, an empty file, no frames.
TEST(CliBadInput, UnreadableFiles) {
  const TempDir dir;
  std::filesystem::create_directory(dir / "folder.ply");
  WriteFileAtomically(dir / "notes.txt", "not a mesh");
  WriteFileAtomically(dir / "empty.ply", "");
  WriteFileAtomically(dir / "noise.ply", std::string(5000, '\xa7'));
  WriteFileAtomically(dir / "noise.obj", std::string(5000, '\xa7'));
  for (const char* name :
       {"folder.ply", "notes.txt", "empty.ply", "noise.ply", "noise.obj"}) {
    ExpectRefused(Reconstruct(dir / "run", {"--mesh=" + dir / name}),
                  kExitInput,
                  {dir / name});
  }
  ExpectRefused(Reconstruct(dir / "run", {"--sequence=" + dir / "folder.ply"}),
                kExitInput,
                {dir / "folder.ply", "frame-"});
  ExpectNothingIn(dir / "run");
}

// Wherever the file ends: in the header, the vertices or the faces.
TEST(CliBadInput, TruncatedPly) {
  const TempDir dir;
  const std::string whole = ReadFile(Fixture("dense.ply"));
  for (const double share : {0.0003, 0.2, 0.7, 0.9999}) {
    WriteFileAtomically(
        dir / "cut.ply",
        whole.substr(0, static_cast<size_t>(share * whole.size())));
    ExpectRefused(Reconstruct(dir / "run", {"--mesh=" + dir / "cut.ply"}),
                  kExitInput,
                  {dir / "cut.ply"});
  }
  ExpectNothingIn(dir / "run");
}

// No vertices, no faces, and faces none of which survives.
TEST(CliBadInput, EmptyMesh) {
  const TempDir dir;
  TriMesh mesh;
  ExpectRefused(ReconstructMesh(dir, mesh), kExitInput, {dir / "bad.ply"});
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  ExpectRefused(ReconstructMesh(dir, mesh), kExitInput, {dir / "bad.ply"});
  mesh.faces = {{0, 0, 1}, {1, 1, 2}};
  ExpectRefused(ReconstructMesh(dir, mesh), kExitInput, {dir / "bad.ply"});
  ExpectNothingIn(dir / "run");
}

TEST(CliBadInput, NotFiniteVertices) {
  const TempDir dir;
  TriMesh mesh = DenseMesh();
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  mesh.vertices[100].x() = kNan;
  mesh.vertices[2000].z() = std::numeric_limits<double>::infinity();
  mesh.vertices[3000].setConstant(kNan);
  const Outcome outcome = ReconstructMesh(dir, mesh);
  ExpectSuccess(outcome);
  ExpectWarning(outcome, dir / "run", "3 vertices");
  ExpectCleanResult(dir / "run");
}

TEST(CliBadInput, ZeroAreaAndDuplicateFaces) {
  const TempDir dir;
  TriMesh mesh = DenseMesh();
  for (int i = 0; i < 50; ++i) {
    const std::array<int, 3> face = mesh.faces[100 * i];
    mesh.faces.push_back(face);                         // again
    mesh.faces.push_back({face[2], face[1], face[0]});  // from behind
    mesh.faces.push_back({face[0], face[0], face[1]});  // an index twice
  }
  const Outcome outcome = ReconstructMesh(dir, mesh);
  ExpectSuccess(outcome);
  ExpectWarning(outcome, dir / "run", "duplicate");
  ExpectCleanResult(dir / "run");
}

// A polygon soup, as many programs write it, is welded to the same surface.
TEST(CliBadInput, CoincidentVertices) {
  const TempDir dir;
  const TriMesh mesh = DenseMesh();
  TriMesh soup;
  for (const auto& face : mesh.faces) {
    const int first = static_cast<int>(soup.NumVertices());
    for (const int v : face) {
      soup.vertices.push_back(mesh.vertices[v]);
      soup.vertex_colors.push_back(mesh.vertex_colors[v]);
    }
    soup.faces.push_back({first, first + 1, first + 2});
  }
  ExpectSuccess(ReconstructMesh(dir, soup));
  ExpectCleanResult(dir / "run");
  const auto faces = [](const std::string& run) {
    return ReadMesh(run + "/partition.ply").mesh.NumFaces();
  };
  EXPECT_EQ(faces(dir / "run"), faces(Fixture("run")));
}

TEST(CliBadInput, NonManifoldEdges) {
  const TempDir dir;
  TriMesh mesh = DenseMesh();
  for (int i = 0; i < 20; ++i) {  // fins: a third face at an edge
    const std::array<int, 3> face = mesh.faces[500 * i];
    const int tip = static_cast<int>(mesh.NumVertices());
    mesh.vertices.push_back(mesh.vertices[face[0]] +
                            Eigen::Vector3d(0.03, 0.05, 0.04));
    mesh.vertex_colors.push_back({200, 200, 200});
    mesh.faces.push_back({face[0], face[1], tip});
  }
  const Outcome outcome = ReconstructMesh(dir, mesh);
  ExpectSuccess(outcome);
  ExpectWarning(outcome, dir / "run", "non-manifold edges");
  ExpectCleanResult(dir / "run");
}

// A few frames that do not decode are left out and counted; a scan of them is
// refused.
TEST(CliBadInput, ImagesThatDoNotDecode) {
  const TempDir dir;
  const ScanCopy some;
  some.Write(some.FrameFile(3, "color.jpg"), "not a picture");
  some.Write(some.FrameFile(8, "depth.png"), "");
  const std::vector<std::string> flags = {"--sequence=" + some.path(),
                                          "--keyframe_window=1"};
  const Outcome outcome = Reconstruct(dir / "run", flags);
  ExpectSuccess(outcome);
  ExpectWarning(outcome, dir / "run", "frame-000003.color.jpg");
  ExpectCleanResult(dir / "run");
  ExpectSuccess(RunProgram("fuse",
                           {"--sequence=" + some.path(),
                            "--voxel_size=0.1",
                            "--output=" + dir / "dense.ply"}));

  const ScanCopy all;
  for (int i = 0; i < ScanCopy::kNumFrames; ++i) {
    all.Write(all.FrameFile(i, "color.jpg"), "not a picture");
  }
  ExpectRefused(Reconstruct(dir / "none", {"--sequence=" + all.path()}),
                kExitInput,
                {"color.jpg"});
  ExpectNothingIn(dir / "none");
}

// Half a JPEG decodes to grey below the cut: it must not pass for a picture.
TEST(CliBadInput, ImagesCutShort) {
  const TempDir dir;
  const ScanCopy scan;
  const std::string whole = ReadFile(scan.FrameFile(5, "color.jpg"));
  scan.Write(scan.FrameFile(5, "color.jpg"), whole.substr(0, whole.size() / 2));
  const Outcome outcome = Reconstruct(
      dir / "run", {"--sequence=" + scan.path(), "--keyframe_window=1"});
  ExpectSuccess(outcome);
  ExpectWarning(outcome, dir / "run", "frame-000005.color.jpg");
}

TEST(CliBadInput, SizesThatDisagreeWithInfo) {
  const TempDir dir;
  for (const char* key : {"m_colorWidth", "m_depthHeight"}) {
    const ScanCopy scan;
    scan.SetInfo(key, "321");
    ExpectRefused(Reconstruct(dir / "run", {"--sequence=" + scan.path()}),
                  kExitInput,
                  {"frame-000000", "160x120", "321", "info.txt"});
  }
  ExpectNothingIn(dir.path());
}

TEST(CliBadInput, MalformedInfo) {
  const TempDir dir;
  const ScanCopy scan;
  scan.SetInfo("m_calibrationColorIntrinsic", "131 0 80");
  ExpectRefused(Reconstruct(dir / "run", {"--sequence=" + scan.path()}),
                kExitInput,
                {"info.txt", "m_calibrationColorIntrinsic"});
  std::filesystem::remove(scan.path() + "/info.txt");
  ExpectRefused(Reconstruct(dir / "run", {"--sequence=" + scan.path()}),
                kExitInput,
                {"info.txt"});
  ExpectNothingIn(dir.path());
}

TEST(CliBadInput, PosesThatAreNotRigid) {
  const TempDir dir;
  const char* const scaled = "2 0 0 0\n0 2 0 0\n0 0 2 0\n0 0 0 1\n";
  const ScanCopy one;
  one.Write(one.FrameFile(4, "pose.txt"), scaled);
  one.Write(one.FrameFile(5, "pose.txt"),
            "-inf -inf -inf -inf\n-inf -inf -inf -inf\n-inf -inf -inf -inf\n"
            "-inf -inf -inf -inf\n");
  const Outcome outcome =
      Reconstruct(dir / "run", {"--sequence=" + one.path()});
  ExpectSuccess(outcome);
  ExpectWarning(outcome, dir / "run", "1 of 24 frames have a pose that is not");
  ExpectWarning(outcome, dir / "run", "1 of 24 frames have a lost pose");

  const ScanCopy all;
  for (int i = 0; i < ScanCopy::kNumFrames; ++i) {
    all.Write(all.FrameFile(i, "pose.txt"), scaled);
  }
  ExpectRefused(Reconstruct(dir / "none", {"--sequence=" + all.path()}),
                kExitInput,
                {"rigid", "pose.txt"});
  ExpectNothingIn(dir / "none");
}

// The room as a box of twelve faces: fewer than clusters are asked for.
TEST(CliBadInput, MeshOfAFewFaces) {
  const TempDir dir;
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& v : DenseMesh().vertices) box.extend(v);
  TriMesh mesh;
  for (int i = 0; i < 8; ++i) {
    mesh.vertices.push_back(
        box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i)));
  }
  // Seen from inside; bit k of a corner is its side along axis k.
  const std::array<int, 4> sides[] = {{0, 1, 3, 2},
                                      {4, 6, 7, 5},
                                      {0, 4, 5, 1},
                                      {2, 3, 7, 6},
                                      {0, 2, 6, 4},
                                      {1, 5, 7, 3}};
  for (const std::array<int, 4>& side : sides) {
    mesh.faces.push_back({side[0], side[1], side[2]});
    mesh.faces.push_back({side[0], side[2], side[3]});
  }
  const Outcome outcome = ReconstructMesh(dir, mesh);
  ExpectSuccess(outcome);
  ExpectWarning(outcome, dir / "run", "only 12 faces");
  const nlohmann::json report = ReadJson(dir / "run/report.json");
  EXPECT_EQ(report["result"]["planes"], 6);
  EXPECT_EQ(report["result"]["faces"], 12);
}

// Frames too far apart to share texels: one view has no residual.
TEST(CliBadInput, OneFrameIsNotEnough) {
  const TempDir dir;
  std::filesystem::create_directory(dir / "scan");
  for (const char* file : {"info.txt",
                           "frame-000005.color.jpg",
                           "frame-000005.depth.png",
                           "frame-000005.pose.txt"}) {
    std::filesystem::create_symlink(Fixture("scan") + "/" + file,
                                    dir / "scan" + "/" + file);
  }
  ExpectRefused(Reconstruct(dir / "run", {"--sequence=" + dir / "scan"}),
                kExitUnsolvable,
                {"seen too rarely", "--keyframe_window"});
}

// The message says what stands in the way of how many observations.
TEST(CliBadInput, MeshThatNoFrameSees) {
  const TempDir dir;
  TriMesh mesh = DenseMesh();
  for (Eigen::Vector3d& v : mesh.vertices) v.x() += 100;
  ExpectRefused(ReconstructMesh(dir, mesh),
                kExitUnsolvable,
                {"sees",
                 "behind or too far",
                 "outside the image",
                 "occluded",
                 "facet-check-input"});
  ExpectNoPartialFile(dir.path());
}

}  // namespace
}  // namespace facet
