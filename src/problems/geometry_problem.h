// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The geometry step: the mesh follows its optimised planes (paper, Eq. geo;
// method, ch. 8).
//
//   E_vert(V) = E_g + lambda3 E_t,    E_t = |L X|_F^2  (mesh/laplacian.h)
//   E_g = sum_f tr[ (V_f - T_f)' M_f (V_f - T_f) ],
//   M_f = A_f / (12 h^2) (I + 1 1')
//
// M_f is the moment of many uniform texels of spacing h over a face of area
// A_f; row k of T_f is corner k projected onto the plane of the face. Linear
// least squares; x, y and z share one sparse Cholesky factor:
//
//   (M + lambda3 L' L) X = B
//
// A vertex shared by several planes goes to the average of its projections. m
// iterations (new projections, same factor, lambda3 / m each) leave 2^-m of its
// distance to a right-angled edge.
#pragma once

#include <vector>

#include "geometry/plane.h"
#include "mesh/laplacian.h"
#include "mesh/planar_partition.h"
#include "mesh/tri_mesh.h"

namespace facet {

// How much of its distance to its plane a corner may keep.
enum class PlaneFreedom {
  kNone,  // the paper: projection onto the plane
  // Distances that look like noise go, those that look like shape stay (method,
  // Sec. 10.6): s is kept by a share that rises smoothly from 0 at |s| = band_m
  // to 1 at 2 band_m. Nothing moves by more than about band_m.
  kBand,
  // All of a cluster keep the share 1 - min(1, (band_m / rms)^2).
  kClusterRms,
};

struct GeometryOptions {
  double lambda3 = 1;  // weight of the smoothness, >= 0
  int iterations = 5;  // >= 1; the paper does one
  LaplacianBoundary boundary = LaplacianBoundary::kChain;
  LaplacianKind laplacian = LaplacianKind::kGlobal;
  PlaneFreedom freedom = PlaneFreedom::kBand;
  double band_m = 0.010;  // > 0 [m]
  // Multiplies E_g by (h / 0.0025 m)^2, so that lambda3 means the same at any
  // spacing of texels (method, Sec. 8.4).
  bool normalize_spacing = true;
  double max_move_m = 0.05;  // longer moves are cut to this length [m], > 0
  bool use_ceres = false;    // the slow oracle instead of the direct solve
};

struct GeometrySummary {
  // Both terms with the targets of the first iteration [m^2 x texels].
  double data_before = 0, data_after = 0;
  double smooth_before = 0, smooth_after = 0;
  // Area-weighted rms distance of the faces to their planes [m].
  double plane_rms_before = 0, plane_rms_after = 0;
  double mean_move_m = 0, max_move_m = 0;
  int clamped_vertices = 0;   // moved by max_move_m
  int restored_vertices = 0;  // blended back, wholly or in part
  int flipped_faces = 0;      // n_f . n_cluster <= 0, before and after:
  int flipped_faces_before = 0;
  int turned_faces = 0;      // normal turned by more than 90 degrees; 0
  int degenerate_faces = 0;  // created by the step; 0
};

// Moves the vertices of `mesh`. `labels` gives the cluster of every face,
// `planes` the optimised plane of every cluster, `texel_spacing_m` is h > 0.
// Vertices without a face stay. Throws OptionsError.
GeometrySummary FitGeometry(const PlanarPartition& labels,
                            const std::vector<Plane>& planes,
                            double texel_spacing_m,
                            const GeometryOptions& options,
                            TriMesh* mesh);

}  // namespace facet
