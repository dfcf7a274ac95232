// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "problems/geometry_problem.h"

#include <ceres/problem.h>
#include <ceres/solver.h>

#include <Eigen/CholmodSupport>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <string>

#include "costs/barycentric_fit.h"
#include "costs/laplacian.h"
#include "problems/geometry_repair.h"
#include "util/errors.h"
#include "util/warnings.h"

namespace facet {
namespace {

using Positions = Eigen::Matrix<double, Eigen::Dynamic, 3>;
using Corners = Eigen::Matrix3d;  // rows = corners of a face
using SparseMatrix = Eigen::SparseMatrix<double>;

constexpr double kReferenceSpacing = 0.0025;  // of the paper [m]

void CheckOptions(const GeometryOptions& options, double texel_spacing_m) {
  const auto require = [](bool ok, const char* what) {
    if (!ok) throw OptionsError(std::string("geometry fit: ") + what);
  };
  require(options.lambda3 >= 0, "lambda3 must not be negative");
  require(options.iterations >= 1, "iterations must be at least 1");
  require(options.band_m > 0, "band_m must be positive");
  require(options.max_move_m > 0, "max_move_m must be positive");
  require(texel_spacing_m > 0, "the texel spacing must be positive");
}

// The share of the distance s that stays; see PlaneFreedom.
double KeptShare(double s, double rms, const GeometryOptions& options) {
  switch (options.freedom) {
    case PlaneFreedom::kNone:
      return 0;
    case PlaneFreedom::kBand: {
      const double t = std::clamp(std::abs(s) / options.band_m - 1.0, 0.0, 1.0);
      return t * t * (3 - 2 * t);
    }
    case PlaneFreedom::kClusterRms: {
      const double ratio = options.band_m / std::max(rms, 1e-12);
      return 1 - std::min(1.0, ratio * ratio);
    }
  }
  return 0;
}

class Fit {
 public:
  Fit(const PlanarPartition& labels,
      const std::vector<Plane>& planes,
      double texel_spacing_m,
      const GeometryOptions& options,
      const TriMesh& mesh);

  // One solve from the targets of `x`.
  Positions Solve(const Positions& x) const {
    return options_.use_ceres ? SolveByCeres(x) : SolveDirectly(x);
  }
  double DataTerm(const Positions& x, const Positions& targets_of) const;
  double SmoothTerm(const Positions& x) const {
    return (laplacian_ * x).squaredNorm();
  }
  double PlaneRms(const Positions& x) const;
  const Positions& Start() const { return start_; }

 private:
  Corners Targets(size_t face, const Positions& x) const;
  void Factorize();
  Positions SolveDirectly(const Positions& x) const;
  Positions SolveByCeres(const Positions& x) const;

  const PlanarPartition& labels_;
  const std::vector<Plane>& planes_;
  const GeometryOptions& options_;
  const TriMesh& mesh_;
  double step_lambda_;                 // lambda3 of one iteration
  Positions start_;                    // the mesh as it came
  std::vector<double> moment_;         // a face: M_f = moment (I + 1 1')
  std::vector<Eigen::Vector3d> kept_;  // a face: distances that stay [m]
  LaplacianStencils stencils_;
  SparseMatrix laplacian_;
  std::vector<int> unknown_;  // a vertex: row of the system, or -1
  SparseMatrix to_fixed_;     // system x all vertices
  int num_unknowns_ = 0;
  Eigen::CholmodSimplicialLLT<SparseMatrix> cholmod_;
  Eigen::SimplicialLDLT<SparseMatrix> simplicial_;
  bool use_cholmod_ = true;
};

Fit::Fit(const PlanarPartition& labels,
         const std::vector<Plane>& planes,
         double texel_spacing_m,
         const GeometryOptions& options,
         const TriMesh& mesh)
    : labels_(labels),
      planes_(planes),
      options_(options),
      mesh_(mesh),
      step_lambda_(options.lambda3 / options.iterations),
      start_(mesh.NumVertices(), 3) {
  for (size_t v = 0; v < mesh.NumVertices(); ++v) {
    start_.row(v) = mesh.vertices[v].transpose();
  }
  const double h =
      options.normalize_spacing ? kReferenceSpacing : texel_spacing_m;
  std::vector<double> mass(mesh.NumVertices(), 0);
  for (size_t f = 0; f < mesh.NumFaces(); ++f) {
    const PlaneCluster& cluster = labels.clusters[labels.face_cluster[f]];
    moment_.push_back(mesh.FaceArea(f) / (12 * h * h));
    // What the vertices keep is their distance to the plane before the
    // optimisation: the shape rides along when the plane moves.
    Eigen::Vector3d kept;
    for (int k = 0; k < 3; ++k) {
      const double s =
          cluster.plane.SignedDistance(mesh.vertices[mesh.faces[f][k]]);
      kept[k] = s * KeptShare(s, cluster.rms, options);
      mass[mesh.faces[f][k]] += moment_.back();
    }
    kept_.push_back(kept);
  }
  stencils_ = MakeLaplacianStencils(
      mesh, labels.face_cluster, options.boundary, options.laplacian);
  laplacian_ = LaplacianMatrix(stencils_.rings);

  unknown_.assign(mesh.NumVertices(), -1);
  for (size_t v = 0; v < mesh.NumVertices(); ++v) {
    const bool fixed =
        options.boundary == LaplacianBoundary::kFixed && stencils_.boundary[v];
    if (mass[v] > 0 && !fixed) unknown_[v] = num_unknowns_++;
  }
  if (!options.use_ceres && num_unknowns_ > 0) Factorize();
}

Corners Fit::Targets(size_t face, const Positions& x) const {
  const Plane& plane = planes_[labels_.face_cluster[face]];
  Corners targets;
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d p = x.row(mesh_.faces[face][k]).transpose();
    const double excess = plane.SignedDistance(p) - kept_[face][k];
    targets.row(k) = (p - excess * plane.normal).transpose();
  }
  return targets;
}

// System matrix M + lambda L'L, split into the columns of unknown and of fixed
// vertices.
void Fit::Factorize() {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(9 * mesh_.NumFaces());
  for (size_t f = 0; f < mesh_.NumFaces(); ++f) {
    for (const int i : mesh_.faces[f]) {
      for (const int k : mesh_.faces[f]) {
        entries.emplace_back(i, k, moment_[f] * (i == k ? 2 : 1));
      }
    }
  }
  const int n = static_cast<int>(mesh_.NumVertices());
  SparseMatrix full(n, n);
  full.setFromTriplets(entries.begin(), entries.end());
  full += step_lambda_ * SparseMatrix(laplacian_.transpose() * laplacian_);

  std::vector<Eigen::Triplet<double>> free_part, fixed_part;
  for (int column = 0; column < n; ++column) {
    for (SparseMatrix::InnerIterator it(full, column); it; ++it) {
      const int row = unknown_[it.row()];
      if (row < 0) continue;
      if (unknown_[column] >= 0) {
        free_part.emplace_back(row, unknown_[column], it.value());
      } else {
        fixed_part.emplace_back(row, column, it.value());
      }
    }
  }
  SparseMatrix system(num_unknowns_, num_unknowns_);
  system.setFromTriplets(free_part.begin(), free_part.end());
  to_fixed_.resize(num_unknowns_, n);
  to_fixed_.setFromTriplets(fixed_part.begin(), fixed_part.end());
  cholmod_.compute(system);
  use_cholmod_ = cholmod_.info() == Eigen::Success;
  if (!use_cholmod_) {
    simplicial_.compute(system);
    if (simplicial_.info() != Eigen::Success) {
      throw UnsolvableError(
          "geometry fit: the normal equations are singular; are there vertices "
          "or planes that are not finite?");
    }
  }
}

Positions Fit::SolveDirectly(const Positions& x) const {
  if (num_unknowns_ == 0) return x;
  Positions rhs = Positions::Zero(num_unknowns_, 3);
  for (size_t f = 0; f < mesh_.NumFaces(); ++f) {
    const Corners targets = Targets(f, x);
    const Eigen::RowVector3d sum = targets.colwise().sum();
    for (int k = 0; k < 3; ++k) {
      const int row = unknown_[mesh_.faces[f][k]];
      if (row >= 0) rhs.row(row) += moment_[f] * (targets.row(k) + sum);
    }
  }
  rhs -= to_fixed_ * x;
  const Positions solution = use_cholmod_ ? Positions(cholmod_.solve(rhs))
                                          : Positions(simplicial_.solve(rhs));
  Positions result = x;
  for (size_t v = 0; v < unknown_.size(); ++v) {
    if (unknown_[v] >= 0) result.row(v) = solution.row(unknown_[v]);
  }
  return result;
}

Positions Fit::SolveByCeres(const Positions& x) const {
  std::vector<Eigen::Vector3d> vertices(unknown_.size());
  ceres::Problem problem;
  for (size_t v = 0; v < vertices.size(); ++v) {
    vertices[v] = x.row(v).transpose();
    problem.AddParameterBlock(vertices[v].data(), 3);
    if (unknown_[v] < 0) problem.SetParameterBlockConstant(vertices[v].data());
  }
  const Eigen::Matrix3d unit =
      Eigen::Matrix3d::Identity() + Eigen::Matrix3d::Ones();
  const Eigen::Matrix3d root = unit.llt().matrixU();
  for (size_t f = 0; f < mesh_.NumFaces(); ++f) {
    const auto& face = mesh_.faces[f];
    problem.AddResidualBlock(
        BarycentricFitCost::Create(std::sqrt(moment_[f]) * root, Targets(f, x)),
        nullptr,
        vertices[face[0]].data(),
        vertices[face[1]].data(),
        vertices[face[2]].data());
  }
  const VertexRings& rings = stencils_.rings;
  for (size_t v = 0; v < vertices.size(); ++v) {
    const int degree = rings.begin[v + 1] - rings.begin[v];
    if (degree == 0) continue;
    std::vector<double*> blocks = {vertices[v].data()};
    for (int k = rings.begin[v]; k < rings.begin[v + 1]; ++k) {
      blocks.push_back(vertices[rings.neighbor[k]].data());
    }
    problem.AddResidualBlock(
        LaplacianCost::Create(degree, step_lambda_), nullptr, blocks);
  }
  // A linear problem: Gauss-Newton, undamped, ends in one step; the rest
  // removes rounding.
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::SPARSE_NORMAL_CHOLESKY;
  solver.initial_trust_region_radius = 1e16;
  solver.max_trust_region_radius = 1e32;
  solver.max_num_iterations = 10;
  solver.function_tolerance = 0;
  solver.gradient_tolerance = 1e-14;
  solver.parameter_tolerance = 1e-15;
  solver.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(solver, &problem, &summary);
  Positions result(x.rows(), 3);
  for (size_t v = 0; v < vertices.size(); ++v) {
    result.row(v) = vertices[v].transpose();
  }
  return result;
}

double Fit::DataTerm(const Positions& x, const Positions& targets_of) const {
  double sum = 0;
  for (size_t f = 0; f < mesh_.NumFaces(); ++f) {
    Corners gap = -Targets(f, targets_of);
    for (int k = 0; k < 3; ++k) gap.row(k) += x.row(mesh_.faces[f][k]);
    sum += moment_[f] * (gap.squaredNorm() + gap.colwise().sum().squaredNorm());
  }
  return sum;
}

// Integral of the squared distance over a face with distances s at the corners:
// A / 12 (sum s_k^2 + (sum s_k)^2).
double Fit::PlaneRms(const Positions& x) const {
  double sum = 0, weight = 0;
  for (size_t f = 0; f < mesh_.NumFaces(); ++f) {
    const Plane& plane = planes_[labels_.face_cluster[f]];
    Eigen::Vector3d s;
    for (int k = 0; k < 3; ++k) {
      s[k] = plane.SignedDistance(x.row(mesh_.faces[f][k]).transpose());
    }
    sum += moment_[f] * (s.squaredNorm() + s.sum() * s.sum());
    weight += 12 * moment_[f];
  }
  return weight > 0 ? std::sqrt(sum / weight) : 0;
}

}  // namespace

GeometrySummary FitGeometry(const PlanarPartition& labels,
                            const std::vector<Plane>& planes,
                            double texel_spacing_m,
                            const GeometryOptions& options,
                            TriMesh* mesh) {
  CheckOptions(options, texel_spacing_m);
  GeometrySummary summary;
  const TriMesh before = *mesh;
  const Fit fit(labels, planes, texel_spacing_m, options, before);
  const Positions& start = fit.Start();
  Positions x = start;
  for (int i = 0; i < options.iterations; ++i) x = fit.Solve(x);

  for (size_t v = 0; v < mesh->NumVertices(); ++v) {
    Eigen::Vector3d move = (x.row(v) - start.row(v)).transpose();
    const double length = move.norm();
    if (length > options.max_move_m) {
      move *= options.max_move_m / length;
      ++summary.clamped_vertices;
    }
    mesh->vertices[v] += move;
  }
  if (summary.clamped_vertices > 0) {
    AddWarning("geometry fit: " + std::to_string(summary.clamped_vertices) +
               " vertices wanted to move farther than max_move_m and were "
               "stopped there");
  }
  summary.restored_vertices = RepairFaces(before, labels, planes, mesh);
  CountSpoiltFaces(before, labels, planes, *mesh, &summary);

  for (size_t v = 0; v < mesh->NumVertices(); ++v) {
    const double moved = (mesh->vertices[v] - before.vertices[v]).norm();
    summary.mean_move_m += moved / static_cast<double>(mesh->NumVertices());
    summary.max_move_m = std::max(summary.max_move_m, moved);
    x.row(v) = mesh->vertices[v].transpose();
  }
  summary.data_before = fit.DataTerm(start, start);
  summary.data_after = fit.DataTerm(x, start);
  summary.smooth_before = fit.SmoothTerm(start);
  summary.smooth_after = fit.SmoothTerm(x);
  summary.plane_rms_before = fit.PlaneRms(start);
  summary.plane_rms_after = fit.PlaneRms(x);
  return summary;
}

}  // namespace facet
