// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "mesh/clean.h"
#include "mesh/mesh_regions.h"
#include "mesh/simplify_internal.h"
#include "tests/mesh/plane_scenes.h"
#include "tests/mesh/simplify_checks.h"
#include "tests/mesh/test_shapes.h"
#include "util/parallel_for.h"
#include "util/random.h"

namespace facet {
namespace {

constexpr int kSmallRegion = 700;  // about 25 of them in the room

// A room of 1 m without a ceiling, with a wavy floor and noisy walls: 16,000
// faces, 120 clusters.
const LabelledMesh& NoisyRoom() {
  static const LabelledMesh room = [] {
    LabelledMesh scene;
    scene.mesh = MakeBoxSoup(1, 40);
    auto& faces = scene.mesh.faces;
    faces.erase(
        std::remove_if(faces.begin(),
                       faces.end(),
                       [&](const std::array<int, 3>& f) {
                         return std::all_of(f.begin(), f.end(), [&](int v) {
                           return scene.mesh.vertices[v].z() > 0.999;
                         });
                       }),
        faces.end());
    CleanMesh({}, &scene.mesh);
    Random random(5);
    for (Eigen::Vector3d& v : scene.mesh.vertices) {
      if (v.z() < 0.01) {
        v.z() += 0.02 * std::sin(9 * v.x()) * std::cos(12 * v.y());
      }
      for (int k = 0; k < 3; ++k) v[k] += 0.002 * random.Normal();
    }
    PartitionOptions options;
    options.target_clusters = 120;
    scene.partition = PartitionMesh(scene.mesh, options);
    return scene;
  }();
  return room;
}

SimplifyOptions Budget(int faces) {
  SimplifyOptions options;
  options.target_faces = faces;
  options.free_error_m = 0;
  options.sweep_ratio = 0;
  return options;
}

SimplifyOptions Counts() {
  SimplifyOptions options;
  options.stop = SimplifyStop::kCounts;
  return options;
}

SimplifyOptions Sweeps() {
  SimplifyOptions options = Budget(1000);
  options.sweep_ratio = 4;
  return options;
}

SimplifyResult Simplify(const SimplifyOptions& options, int faces_per_region) {
  return SimplifyInRegions(
      NoisyRoom().mesh, NoisyRoom().partition, options, faces_per_region);
}

// Mean distance of the vertices of the room to the light mesh.
double MeanDistance(const TriMesh& light) {
  double sum = 0;
  for (const Eigen::Vector3d& p : NoisyRoom().mesh.vertices) {
    double nearest = 1;
    for (size_t f = 0; f < light.NumFaces(); ++f) {
      const Eigen::Vector3d& a = light.vertices[light.faces[f][0]];
      const Eigen::Vector3d u = light.vertices[light.faces[f][1]] - a;
      const Eigen::Vector3d v = light.vertices[light.faces[f][2]] - a;
      const Eigen::Vector3d n = u.cross(v);
      const Eigen::Vector3d d = p - a;
      const double s = d.cross(v).dot(n) / n.squaredNorm();
      const double t = u.cross(d).dot(n) / n.squaredNorm();
      if (s < 0 || t < 0 || s + t > 1) continue;
      nearest = std::min(nearest, std::abs(d.dot(n)) / n.norm());
    }
    if (nearest < 0.1) sum += nearest;
  }
  return sum / static_cast<double>(NoisyRoom().mesh.NumVertices());
}

// Breaks if a face is lost, is in two regions, or a cluster is torn apart.
TEST(SimplifyRegions, EveryClusterIsInOneRegion) {
  const std::vector<int>& label = NoisyRoom().partition.face_cluster;
  for (const int size : {1, kSmallRegion, 100000}) {
    const MeshRegions regions = DivideIntoRegions(
        NoisyRoom().mesh, NoisyRoom().partition.face_cluster, size);
    std::set<int> faces, clusters;
    for (int r = 0; r < regions.Count(); ++r) {
      std::set<int> mine;
      for (int i = regions.begin[r]; i < regions.begin[r + 1]; ++i) {
        EXPECT_TRUE(faces.insert(regions.faces[i]).second);
        mine.insert(label[regions.faces[i]]);
      }
      EXPECT_TRUE(regions.begin[r + 1] - regions.begin[r] <= size ||
                  mine.size() == 1);
      for (const int id : mine) EXPECT_TRUE(clusters.insert(id).second);
    }
    EXPECT_EQ(faces.size(), label.size());
    const int least = size == 1 ? 120 : size == kSmallRegion ? 20 : 1;
    const int most = size == 1 ? 120 : size == kSmallRegion ? 60 : 1;
    EXPECT_GE(regions.Count(), least);
    EXPECT_LE(regions.Count(), most);
  }
}

// Breaks if a mesh without faces, or ids without faces, are not divided.
TEST(SimplifyRegions, DividesWhatIsMissing) {
  EXPECT_EQ(DivideIntoRegions({}, {}, 10).Count(), 1);
  LabelledMesh sheet = MakeSheet(2, [](double, double) { return 0.0; });
  for (int& id : sheet.partition.face_cluster) id *= 7;
  EXPECT_EQ(
      DivideIntoRegions(sheet.mesh, sheet.partition.face_cluster, 8).Count(),
      2);
}

// Breaks if regions that collapse at the same time see each other.
TEST(SimplifyRegions, SameBytesAtAnyThreadCount) {
  for (const SimplifyOptions& options : {Budget(800), Sweeps(), Counts()}) {
    SetNumThreads(1);
    const SimplifyResult one = Simplify(options, kSmallRegion);
    for (const int threads : {2, 5}) {
      SetNumThreads(threads);
      const SimplifyResult other = Simplify(options, kSmallRegion);
      EXPECT_EQ(one.mesh.faces, other.mesh.faces);
      EXPECT_EQ(one.mesh.vertices, other.mesh.vertices);
      EXPECT_EQ(one.partition.face_cluster, other.partition.face_cluster);
      EXPECT_EQ(one.vertex_birth, other.vertex_birth);
      EXPECT_EQ(one.report.collapses, other.report.collapses);
      EXPECT_EQ(one.report.max_error_m, other.report.max_error_m);
    }
    SetNumThreads(0);
  }
}

// Breaks if a collapse inside a region harms what is beside it, if counts of
// regions get lost, or regions pass the budget.
TEST(SimplifyRegions, ManySmallRegionsKeepTheGuarantees) {
  for (const int size : {60, 250, kSmallRegion}) {
    for (const SimplifyOptions& options :
         {Budget(1000), Budget(300), Sweeps(), Counts()}) {
      const SimplifyResult result = Simplify(options, size);
      ExpectSound(NoisyRoom(), result);
      // A collapse takes two faces away, on the boundary one.
      const int gone = result.report.faces_before - result.report.faces_after;
      EXPECT_LE(gone, 2 * result.report.collapses);
      EXPECT_GT(gone, 1.9 * result.report.collapses);
      if (options.target_faces == 1000) {
        EXPECT_LE(result.report.faces_after, 1000);
        EXPECT_GE(result.report.faces_after, 998);
      }
    }
  }
}

// Breaks if births do not follow the vertices into the order of the regions.
TEST(SimplifyRegions, BirthsAreVerticesOfTheInput) {
  SimplifyOptions options = Counts();
  options.border_ratio = 1;
  const SimplifyResult result = Simplify(options, kSmallRegion);
  const std::vector<int>& birth = result.vertex_birth;
  EXPECT_EQ(std::set<int>(birth.begin(), birth.end()).size(), birth.size());
  double sum = 0;
  for (size_t v = 0; v < birth.size(); ++v) {
    sum +=
        (result.mesh.vertices[v] - NoisyRoom().mesh.vertices[birth[v]]).norm();
  }
  EXPECT_LT(sum / static_cast<double>(birth.size()), 0.01);
}

// Breaks if step 1 goes further inside regions than at their seams, or misses
// its counts.
TEST(SimplifyRegions, StepOneLeavesAsMuchAsWithoutRegions) {
  const SimplifyResult whole = Simplify(Counts(), 1000000);
  const SimplifyResult parts = Simplify(Counts(), kSmallRegion);
  EXPECT_NEAR(parts.report.faces_after,
              whole.report.faces_after,
              0.05 * whole.report.faces_after);
  EXPECT_LT(MeanDistance(parts.mesh), 1.1 * MeanDistance(whole.mesh));
}

// Breaks if seams cost shape: the mesh is as near to the dense one as without
// regions, with regions a hundredth of the usual size.
TEST(SimplifyRegions, SeamsCostLittleShape) {
  for (const int faces : {800, 2000}) {
    const SimplifyResult whole = Simplify(Budget(faces), 1000000);
    const SimplifyResult parts = Simplify(Budget(faces), kSmallRegion);
    EXPECT_NE(whole.vertex_birth, parts.vertex_birth);  // there were regions
    EXPECT_LT(MeanDistance(parts.mesh), 1.04 * MeanDistance(whole.mesh));
  }
}

}  // namespace
}  // namespace facet
