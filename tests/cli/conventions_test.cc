// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Scans in another convention: facet-check-input says which one fits, and
// facet-reconstruct does not make a black model of them in silence.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <sstream>

#include "mesh/mesh_io.h"
#include "tests/cli/cli_run.h"
#include "util/atomic_file.h"
#include "util/errors.h"

namespace facet {
namespace {

// World-to-camera where camera-to-world is expected.
void InvertPoses(const ScanCopy& scan) {
  for (int i = 0; i < ScanCopy::kNumFrames; ++i) {
    const std::string file = scan.FrameFile(i, "pose.txt");
    std::istringstream in(ReadFile(file));
    Eigen::Matrix4d m;
    for (int k = 0; k < 16; ++k) in >> m(k / 4, k % 4);
    std::ostringstream out;
    out.precision(12);
    out << m.inverse().eval() << "\n";
    scan.Write(file, out.str());
  }
}

Outcome CheckInput(const std::string& sequence) {
  return RunProgram(
      "check-input",
      {"--sequence=" + sequence, "--mesh=" + Fixture("dense.ply")});
}

// Either refused with exit code 4, or finished with a warning; both send the
// user to facet-check-input.
void ExpectNotSilent(const Outcome& outcome) {
  EXPECT_TRUE(outcome.code == kExitOk || outcome.code == kExitUnsolvable)
      << outcome.command << " ended with " << outcome.code;
  EXPECT_NE(outcome.err.find("facet-check-input"), std::string::npos)
      << outcome.command << "\n"
      << outcome.err;
}

TEST(CliConventions, GoodScanFits) {
  const Outcome outcome = CheckInput(Fixture("scan"));
  ExpectSuccess(outcome);
  EXPECT_NE(outcome.out.find("The given conventions fit"), std::string::npos);
}

TEST(CliConventions, InversePoses) {
  const ScanCopy scan;
  InvertPoses(scan);
  const Outcome check = CheckInput(scan.path());
  EXPECT_EQ(check.code, kExitInput);
  EXPECT_NE(check.out.find("inverse pose"), std::string::npos) << check.out;
  const TempDir dir;
  ExpectNotSilent(Reconstruct(dir / "run", {"--sequence=" + scan.path()}));
}

// Breaks if the user learns of a wrong convention when the long solve is done,
// or if a good scan is suspected.
TEST(CliConventions, ToldBeforeTheSolve) {
  const ScanCopy scan;
  InvertPoses(scan);
  const TempDir dir;
  const std::vector<std::string> flags = {"--sequence=" + scan.path(),
                                          "--to_stage=keyframes"};
  const Outcome outcome = Reconstruct(dir / "run", flags);
  ExpectSuccess(outcome);
  ExpectWarning(outcome, dir / "run", "world-to-camera");
  ExpectWarning(outcome, dir / "run", "facet-check-input");
  const std::string of_good_scan =
      ReadJson(Fixture("run/report.json"))["warnings"].dump();
  EXPECT_EQ(of_good_scan.find("facet-check-input"), std::string::npos);
}

// Raw units of 1 mm read as 0.2 mm, 4 mm and whole metres.
TEST(CliConventions, WrongDepthUnit) {
  for (const char* shift : {"5000", "256", "1"}) {
    const ScanCopy scan;
    scan.SetInfo("m_depthShift", shift);
    const Outcome check = CheckInput(scan.path());
    EXPECT_EQ(check.code, kExitInput) << shift;
    EXPECT_NE(check.out.find("1000"), std::string::npos) << check.out;
    const TempDir dir;
    ExpectNotSilent(Reconstruct(dir / "run", {"--sequence=" + scan.path()}));
  }
}

// All faces turned over: the depth fits, but no texel faces a camera.
TEST(CliConventions, MeshInsideOut) {
  const TempDir dir;
  TriMesh mesh = ReadMesh(Fixture("dense.ply")).mesh;
  for (auto& face : mesh.faces) std::swap(face[1], face[2]);
  WritePly(dir / "turned.ply", mesh);
  ExpectRefused(Reconstruct(dir / "run", {"--mesh=" + dir / "turned.ply"}),
                kExitUnsolvable,
                {"from behind", "facet-check-input"});
  const Outcome check = RunProgram(
      "check-input",
      {"--sequence=" + Fixture("scan"), "--mesh=" + dir / "turned.ply"});
  EXPECT_EQ(check.code, kExitInput);
  EXPECT_NE(check.out.find("inside out"), std::string::npos) << check.out;
}

// Millimetres instead of metres: no frame sees the mesh in range.
TEST(CliConventions, FusionOfWrongDepthIsRefusedOrSmall) {
  const ScanCopy scan;
  scan.SetInfo("m_depthShift", "1");
  const TempDir dir;
  ExpectRefused(RunProgram("fuse",
                           {"--sequence=" + scan.path(),
                            "--voxel_size=0.1",
                            "--output=" + dir / "dense.ply"}),
                kExitUnsolvable,
                {"m_depthShift", "facet-check-input"});
  ExpectNothingIn(dir.path());
}

}  // namespace
}  // namespace facet
