// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "problems/geometry_problem.h"

#include <gtest/gtest.h>

#include "mesh/mesh_checks.h"
#include "tests/mesh/plane_scenes.h"
#include "util/errors.h"
#include "util/random.h"

namespace facet {
namespace {

std::vector<Plane> PlanesOf(const PlanarPartition& partition) {
  std::vector<Plane> planes;
  for (const PlaneCluster& c : partition.clusters) planes.push_back(c.plane);
  return planes;
}

void Shake(double amplitude, TriMesh* mesh) {
  Random random(3);
  for (auto& v : mesh->vertices) {
    v += amplitude * Eigen::Vector3d(random.Uniform(-1, 1),
                                     random.Uniform(-1, 1),
                                     random.Uniform(-1, 1));
  }
}

double Gap(const TriMesh& a, const TriMesh& b) {
  double gap = 0;
  for (size_t v = 0; v < a.NumVertices(); ++v) {
    gap = std::max(gap, (a.vertices[v] - b.vertices[v]).norm());
  }
  return gap;
}

// Breaks if the assembled normal equations and the residuals of Ceres are not
// the same problem, in any of the variants.
TEST(GeometryProblem, DirectAgreesWithCeres) {
  LabelledMesh scene = MakeCube(4);
  Shake(0.01, &scene.mesh);
  LabelledMesh sheet = MakeSheet(
      5, [](double x, double y) { return 0.01 * std::sin(9 * x + y); });
  for (const LabelledMesh& in : {scene, sheet}) {
    for (const auto boundary : {LaplacianBoundary::kPaper,
                                LaplacianBoundary::kChain,
                                LaplacianBoundary::kFixed}) {
      for (const auto kind :
           {LaplacianKind::kGlobal, LaplacianKind::kFeature}) {
        GeometryOptions options;
        options.iterations = 2;
        options.boundary = boundary;
        options.laplacian = kind;
        TriMesh direct = in.mesh, ceres = in.mesh;
        const auto planes = PlanesOf(in.partition);
        FitGeometry(in.partition, planes, 0.004, options, &direct);
        options.use_ceres = true;
        FitGeometry(in.partition, planes, 0.004, options, &ceres);
        EXPECT_LT(Gap(direct, ceres), 1e-8);
        EXPECT_GT(Gap(direct, in.mesh), 1e-5);
      }
    }
  }
}

// Breaks if the targets are not the projections: a mesh on its planes, without
// smoothing, stays; one off its planes by d is moved back by d.
TEST(GeometryProblem, MovesWithItsPlanes) {
  LabelledMesh sheet = MakeSheet(4, [](double, double) { return 0.0; });
  GeometryOptions options;
  options.lambda3 = 0;
  TriMesh mesh = sheet.mesh;
  std::vector<Plane> planes = PlanesOf(sheet.partition);
  FitGeometry(sheet.partition, planes, 0.0025, options, &mesh);
  EXPECT_LT(Gap(mesh, sheet.mesh), 1e-12);
  for (Plane& plane : planes) plane.offset -= 0.004;
  FitGeometry(sheet.partition, planes, 0.0025, options, &mesh);
  for (size_t v = 0; v < mesh.NumVertices(); ++v) {
    const Eigen::Vector3d moved = mesh.vertices[v] - sheet.mesh.vertices[v];
    EXPECT_LT((moved - Eigen::Vector3d(0, 0, 0.004)).norm(), 1e-12);
  }
}

// Breaks if an iteration does not halve what is left at a right-angled edge
// (method, Sec. 8.3): both planes of the edge move outwards by d.
TEST(GeometryProblem, IterationsGoToTheIntersection) {
  const LabelledMesh cube = MakeCube(2);
  std::vector<Plane> planes = PlanesOf(cube.partition);
  const double d = 0.004;
  for (Plane& plane : planes) plane.offset -= d;
  double left[3] = {0, 0, 0};
  for (int m = 1; m <= 2; ++m) {
    GeometryOptions options;
    options.lambda3 = 0;
    options.iterations = m == 1 ? 1 : 40;
    TriMesh mesh = cube.mesh;
    FitGeometry(cube.partition, planes, 0.0025, options, &mesh);
    for (size_t v = 0; v < mesh.NumVertices(); ++v) {
      // Corners of the enlarged cube.
      Eigen::Vector3d corner = cube.mesh.vertices[v];
      if ((corner.array() * (1 - corner.array())).abs().maxCoeff() > 1e-9) {
        continue;
      }
      corner += d * (2 * corner - Eigen::Vector3d::Ones());
      left[m] = std::max(left[m], (mesh.vertices[v] - corner).norm());
    }
  }
  EXPECT_GT(left[1], 0.3 * d);
  EXPECT_LT(left[2], 1e-3 * d);
}

// Breaks if the answer depends on the spacing of texels although E_g is
// normalised, or does not although it is not.
TEST(GeometryProblem, NormalisationTakesOutTheSpacing) {
  LabelledMesh scene = MakeCube(6);
  Shake(0.01, &scene.mesh);
  const auto planes = PlanesOf(scene.partition);
  for (const bool normalize : {true, false}) {
    GeometryOptions options;
    options.normalize_spacing = normalize;
    TriMesh fine = scene.mesh, coarse = scene.mesh;
    FitGeometry(scene.partition, planes, 0.002, options, &fine);
    FitGeometry(scene.partition, planes, 0.02, options, &coarse);
    EXPECT_EQ(Gap(fine, coarse) < 1e-12, normalize);
  }
}

// Breaks if noise is kept, or if shape in a cluster that is not planar is
// flattened; the paper's projection flattens both.
TEST(GeometryProblem, BandKeepsShapeAndTakesNoise) {
  LabelledMesh sheet = MakeSheet(20, [](double x, double y) {
    const double r = std::hypot(x - 0.25, y - 0.5);
    return 0.05 * std::exp(-r * r / 0.01) + 0.001 * std::sin(57 * x + 91 * y);
  });
  for (PlaneCluster& c : sheet.partition.clusters) c.plane = Plane();
  const auto peak_and_noise = [&](PlaneFreedom freedom) {
    GeometryOptions options;
    options.lambda3 = 0;
    options.freedom = freedom;
    options.max_move_m = 1;
    TriMesh mesh = sheet.mesh;
    FitGeometry(
        sheet.partition, PlanesOf(sheet.partition), 0.0025, options, &mesh);
    double peak = 0, noise = 0;
    for (const auto& v : mesh.vertices) {
      peak = std::max(peak, v.z());
      if (v.x() > 0.7) noise = std::max(noise, std::abs(v.z()));
    }
    return std::make_pair(peak, noise);
  };
  const auto [band_peak, band_noise] = peak_and_noise(PlaneFreedom::kBand);
  EXPECT_GT(band_peak, 0.045);
  EXPECT_LT(band_noise, 1e-9);
  const auto [paper_peak, paper_noise] = peak_and_noise(PlaneFreedom::kNone);
  EXPECT_LT(paper_peak, 1e-9);
  EXPECT_LT(paper_noise, 1e-9);
}

// Breaks if a plane that has run away takes the mesh with it, turns faces over
// or leaves some without area.
TEST(GeometryProblem, WildPlanesDoNoHarm) {
  LabelledMesh scene = MakeCube(5);
  Shake(0.02, &scene.mesh);
  std::vector<Plane> planes = PlanesOf(scene.partition);
  planes[0].normal = Eigen::Vector3d(1, 5, -2).normalized();
  planes[1].offset += 3;
  GeometryOptions options;
  options.max_move_m = 0.3;
  TriMesh mesh = scene.mesh;
  const GeometrySummary summary =
      FitGeometry(scene.partition, planes, 0.0025, options, &mesh);
  EXPECT_GT(summary.clamped_vertices, 0);
  EXPECT_LE(summary.max_move_m, 0.3 + 1e-12);
  EXPECT_EQ(summary.turned_faces, 0);
  EXPECT_EQ(summary.degenerate_faces, 0);
  EXPECT_EQ(CheckMesh(mesh).degenerate_faces, 0);
}

// Breaks if a vertex without a face enters the system, or fixed ones move.
TEST(GeometryProblem, LooseAndFixedVerticesStay) {
  LabelledMesh sheet =
      MakeSheet(4, [](double x, double y) { return 0.01 * x * y; });
  sheet.mesh.vertices.push_back({7, 8, 9});
  GeometryOptions options;
  options.boundary = LaplacianBoundary::kFixed;
  TriMesh mesh = sheet.mesh;
  FitGeometry(
      sheet.partition, PlanesOf(sheet.partition), 0.0025, options, &mesh);
  EXPECT_EQ(mesh.vertices.back(), sheet.mesh.vertices.back());
  for (size_t v = 0; v < mesh.NumVertices(); ++v) {
    const Eigen::Vector3d& p = sheet.mesh.vertices[v];
    if (p.x() == 0 || p.y() == 0) {
      EXPECT_EQ(mesh.vertices[v], p);
    }
  }
}

TEST(GeometryProblem, RefusesBadOptions) {
  LabelledMesh sheet = MakeSheet(2, [](double, double) { return 0.0; });
  GeometryOptions options;
  options.iterations = 0;
  EXPECT_THROW(FitGeometry(sheet.partition,
                           PlanesOf(sheet.partition),
                           0.0025,
                           options,
                           &sheet.mesh),
               OptionsError);
}

}  // namespace
}  // namespace facet
