// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "pipeline/artefacts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>

#include "tests/support/temp_dir.h"
#include "util/atomic_file.h"
#include "util/errors.h"
#include "util/random.h"

namespace facet {
namespace {

using ::testing::HasSubstr;

// Numbers that text would change: not representable in decimal, denormal, -0.
double Awkward(int i) {
  constexpr double kTiny = std::numeric_limits<double>::denorm_min();
  switch (i % 4) {
    case 0:
      return -0.0;
    case 1:
      return kTiny * (i + 1);
    case 2:
      return (i + 1) / 3.0;
    default:
      return -1e300 / (i + 7);
  }
}

Eigen::Vector3d AwkwardPoint(int i) {
  return {Awkward(3 * i), Awkward(3 * i + 1), Awkward(3 * i + 2)};
}

// Equal to the last bit, so that -0 differs from 0 and NaN equals NaN.
template <typename T>
bool SameBits(const T& a, const T& b) {
  return std::memcmp(&a, &b, sizeof(T)) == 0;
}

void ExpectSame(const Plane& a, const Plane& b) {
  for (int k = 0; k < 3; ++k) {
    EXPECT_TRUE(SameBits(a.normal[k], b.normal[k]));
  }
  EXPECT_TRUE(SameBits(a.offset, b.offset));
}

TriMesh AwkwardMesh() {
  TriMesh mesh;
  for (int i = 0; i < 40; ++i) {
    mesh.vertices.push_back(AwkwardPoint(i));
    mesh.vertex_colors.push_back({static_cast<uint8_t>(i), 255, 0});
  }
  for (int i = 0; i < 38; ++i) mesh.faces.push_back({i, i + 1, i + 2});
  return mesh;
}

void ExpectSame(const TriMesh& a, const TriMesh& b) {
  EXPECT_EQ(a.faces, b.faces);
  EXPECT_EQ(a.vertex_colors, b.vertex_colors);
  ASSERT_EQ(a.NumVertices(), b.NumVertices());
  for (size_t v = 0; v < a.NumVertices(); ++v) {
    for (int k = 0; k < 3; ++k) {
      EXPECT_TRUE(SameBits(a.vertices[v][k], b.vertices[v][k]));
    }
  }
}

MeshArtefact SomeMeshArtefact() {
  MeshArtefact artefact;
  artefact.mesh = AwkwardMesh();
  for (int j = 0; j < 3; ++j) {
    PlaneCluster cluster;
    cluster.plane.normal = AwkwardPoint(j + 5);
    cluster.plane.offset = Awkward(j + 2);
    cluster.centroid = AwkwardPoint(j);
    cluster.area = 1.0 / (j + 3);
    cluster.rms = 1e-3 / (j + 3);
    cluster.num_faces = 10 + j;
    artefact.partition.clusters.push_back(cluster);
    artefact.refitted_planes.push_back(cluster.plane);
  }
  for (int f = 0; f < 38; ++f) artefact.partition.face_cluster.push_back(f % 3);
  artefact.report = {{"faces", 38}, {"rms", 0.1}};
  artefact.warnings = {"opened 3 edges", "dropped \"2\" faces"};
  return artefact;
}

class ArtefactTest : public ::testing::Test {
 protected:
  ArtefactTest() {
    options_.sequence_path = "scan";
    options_.mesh_path = "dense.ply";
    options_.output_path = dir_ / "run";
  }
  std::string ErrorOfLoading(Stage stage) const {
    try {
      LoadMeshArtefact(options_, stage);
    } catch (const OptionsError& e) {
      return e.what();
    } catch (const InputError& e) {
      return std::string("input: ") + e.what();
    }
    return "";
  }
  TempDir dir_;
  ReconstructOptions options_;
};

// Breaks if an array is left out or rounded on its way to the file.
TEST_F(ArtefactTest, MeshComesBackBitForBit) {
  const MeshArtefact out = SomeMeshArtefact();
  for (const Stage stage : {Stage::kPartition, Stage::kSimplify}) {
    Save(options_, stage, out);
    const MeshArtefact in = LoadMeshArtefact(options_, stage);
    ExpectSame(in.mesh, out.mesh);
    EXPECT_EQ(in.partition.face_cluster, out.partition.face_cluster);
    ASSERT_EQ(in.partition.clusters.size(), out.partition.clusters.size());
    for (size_t j = 0; j < out.partition.clusters.size(); ++j) {
      const PlaneCluster& a = in.partition.clusters[j];
      const PlaneCluster& b = out.partition.clusters[j];
      ExpectSame(a.plane, b.plane);
      EXPECT_EQ(a.centroid, b.centroid);
      EXPECT_EQ(a.area, b.area);
      EXPECT_EQ(a.rms, b.rms);
      EXPECT_EQ(a.num_faces, b.num_faces);
      ExpectSame(in.refitted_planes[j], out.refitted_planes[j]);
    }
    EXPECT_EQ(in.report, out.report);
    EXPECT_EQ(in.warnings, out.warnings);
  }
}

// A mesh without colours stays one.
TEST_F(ArtefactTest, ColoursAreOptional) {
  MeshArtefact out = SomeMeshArtefact();
  out.mesh.vertex_colors.clear();
  Save(options_, Stage::kPartition, out);
  EXPECT_TRUE(
      LoadMeshArtefact(options_, Stage::kPartition).mesh.vertex_colors.empty());
}

// NaN stands for a frame that was not measured.
TEST_F(ArtefactTest, KeyframesComeBack) {
  KeyframeArtefact out;
  out.keyframes = {0, 7, 9};
  out.blur = {0.1, std::numeric_limits<double>::quiet_NaN(), 1.0 / 3};
  Save(options_, out);
  const KeyframeArtefact in = LoadKeyframeArtefact(options_);
  EXPECT_EQ(in.keyframes, out.keyframes);
  ASSERT_EQ(in.blur.size(), 3u);
  EXPECT_EQ(in.blur[0], out.blur[0]);
  EXPECT_TRUE(std::isnan(in.blur[1]));
  EXPECT_EQ(in.blur[2], out.blur[2]);
}

// Breaks if poses are normalised again on their way: many quaternions change
// in the last bit then, and a resumed run differs from one in one go.
TEST_F(ArtefactTest, PhotometricComesBackBitForBit) {
  PhotometricArtefact out;
  Random random(3);
  for (int k = 0; k < 500; ++k) {
    Vector6d xi;
    for (int i = 0; i < 6; ++i) xi[i] = random.Normal();
    out.cam_from_world.push_back(ExpSe3(xi));
    out.planes.push_back({AwkwardPoint(k), Awkward(k)});
    out.warps.push_back(Awkward(k));
    out.plane_texels.push_back(k);
    out.plane_frames.push_back(2 * k);
  }
  out.lattice = {5, 4, 640, 480};
  out.report = {{"slide", {{"mm", 0.25}}}};
  Save(options_, out);
  const PhotometricArtefact in = LoadPhotometricArtefact(options_);
  ASSERT_EQ(in.cam_from_world.size(), out.cam_from_world.size());
  for (size_t k = 0; k < out.cam_from_world.size(); ++k) {
    const Pose &a = in.cam_from_world[k], &b = out.cam_from_world[k];
    EXPECT_EQ(a.rotation.coeffs(), b.rotation.coeffs()) << k;
    EXPECT_EQ(a.translation, b.translation) << k;
    ExpectSame(in.planes[k], out.planes[k]);
    EXPECT_TRUE(SameBits(in.warps[k], out.warps[k]));
  }
  EXPECT_EQ(in.lattice.columns, 5);
  EXPECT_EQ(in.lattice.height, 480);
  EXPECT_EQ(in.plane_texels, out.plane_texels);
  EXPECT_EQ(in.plane_frames, out.plane_frames);
  EXPECT_EQ(in.report, out.report);
}

TEST_F(ArtefactTest, GeometryComesBackBitForBit) {
  GeometryArtefact out;
  out.mesh = AwkwardMesh();
  Save(options_, out);
  ExpectSame(LoadGeometryArtefact(options_).mesh, out.mesh);
}

// The message names the file and the stage that writes it.
TEST_F(ArtefactTest, MissingFileNamesTheStage) {
  const std::string error = ErrorOfLoading(Stage::kSimplify);
  EXPECT_THAT(error, HasSubstr("input: "));
  EXPECT_THAT(error, HasSubstr("simplify.bin"));
  EXPECT_THAT(error, HasSubstr("--from_stage=simplify"));
}

// At every length, and with another file in its place: an error, never a crash.
TEST_F(ArtefactTest, DamagedFilesAreRefused) {
  Save(options_, Stage::kPartition, SomeMeshArtefact());
  const std::string path = ArtefactPath(options_, Stage::kPartition);
  const std::string whole = ReadFile(path);
  for (size_t size = 1; size < whole.size(); size += 97) {
    WriteFileAtomically(path, whole.substr(0, size));
    EXPECT_THAT(ErrorOfLoading(Stage::kPartition), HasSubstr("partition.bin"))
        << "cut to " << size;
  }
  std::string changed = whole;
  changed[8] = '\xff';  // length of the header
  changed[15] = '\x7f';
  WriteFileAtomically(path, changed);
  EXPECT_THAT(ErrorOfLoading(Stage::kPartition), HasSubstr("partition.bin"));

  Save(options_, KeyframeArtefact());
  std::filesystem::copy_file(ArtefactPath(options_, Stage::kKeyframes),
                             path,
                             std::filesystem::copy_options::overwrite_existing);
  EXPECT_THAT(ErrorOfLoading(Stage::kPartition), HasSubstr("partition.bin"));
}

// Settings of the stage and of those before are guarded, later ones are free.
TEST_F(ArtefactTest, OtherSettingsAreRefusedByName) {
  Save(options_, Stage::kSimplify, SomeMeshArtefact());
  EXPECT_EQ(ErrorOfLoading(Stage::kSimplify), "");

  const ReconstructOptions good = options_;
  options_.merge.max_normal_deg = 12.5;
  EXPECT_THAT(ErrorOfLoading(Stage::kSimplify),
              HasSubstr("--merge_max_normal_deg = 8.0, now it is 12.5"));
  EXPECT_THAT(ErrorOfLoading(Stage::kSimplify),
              HasSubstr("--from_stage=partition"));
  options_ = good;
  options_.simplify.target_faces = 77;
  EXPECT_THAT(ErrorOfLoading(Stage::kSimplify), HasSubstr("--simplify_faces"));
  EXPECT_THAT(ErrorOfLoading(Stage::kSimplify),
              HasSubstr("--from_stage=simplify"));
  options_ = good;
  options_.mesh_path = "other.ply";
  EXPECT_THAT(ErrorOfLoading(Stage::kSimplify), HasSubstr("other.ply"));
  options_ = good;
  options_.photometric.schedule = "C";
  options_.geometry.lambda3 = 9;
  options_.bake.robust_luma = 0.5;
  EXPECT_EQ(ErrorOfLoading(Stage::kSimplify), "");
}

// With the flags of both runs at hand, their values are shown as the user gives
// them, not as numbers of an enumeration.
TEST_F(ArtefactTest, RefusalQuotesTheFlags) {
  options_.flags_text = "--mesh=a.ply\n--simplify_stop=budget\n--threads=1\n";
  Save(options_, Stage::kSimplify, SomeMeshArtefact());
  options_.simplify.stop = SimplifyStop::kCounts;
  options_.flags_text = "--simplify_stop=counts\n";
  EXPECT_THAT(
      ErrorOfLoading(Stage::kSimplify),
      HasSubstr(
          "with --simplify_stop=budget, now it is --simplify_stop=counts"));
}

}  // namespace
}  // namespace facet
