// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Two-step cluster-wise simplification by quadric error metrics (paper,
// Sec. 3.2; method, ch. 3): few large triangles inside the planes, shape kept
// where planes meet. Edges fall into three classes:
//
//   inner    no end on a cluster border (or one end, with collapse_to_border):
//            step 1 collapses them, border vertices stay where they are;
//   border   mesh boundary, or between two clusters: step 2 collapses them,
//            inner vertices stay where they are;
//   chord    both ends on borders, the edge itself inside a cluster: never
//            collapsed, it would pinch the cluster.
//
// Corners (border vertices with other than two border edges) move and merge
// like other border vertices: the triple points of noisy clusters are nothing
// to hold on to, and those of the room are held by their quadrics. A collapse
// must pass the link condition, on the mesh and on its labels, and the shape
// checks below.
#pragma once

#include <vector>

#include "mesh/mesh_checks.h"
#include "mesh/planar_partition.h"
#include "mesh/tri_mesh.h"

namespace facet {

enum class SimplifyStop {
  // The literal paper: step 1 until every cluster has inner_target inner edges,
  // step 2 until border_ratio of the border edges is left, `passes` times.
  kCounts,
  // Both steps interleaved, cheapest collapse first over all clusters, until
  // the face budget is met: the faces go where the shape needs them.
  kBudget,
};

struct SimplifyOptions {
  SimplifyStop stop = SimplifyStop::kBudget;

  // kCounts.
  int inner_target = 10;      // inner edges left in a cluster, >= 0
  double border_ratio = 0.1;  // border edges left, share of all, in (0, 1]
  int min_border_edges = 10;  // ... but not fewer than this
  int passes = 2;             // >= 1

  // kBudget. Number of faces to stop at; 0 = faces_per_m2 x area of the mesh.
  int target_faces = 0;
  double faces_per_m2 = 1000;
  // With the budget by area: no collapse of more squared error times area, here
  // that of 4.5 mm over 100 cm2. Clutter keeps more faces than its area says
  // [m^4].
  double max_cost_m4 = 2e-7;
  // Of larger meshes, sweeps over all edges that collapse the cheaper half of
  // them leave this many times the budget to the collapses in order of cost,
  // which take several times as long a face. >= 1; 0 = no sweeps.
  double sweep_ratio = 40;
  // Collapses with a smaller rms error are made even below the budget [m].
  double free_error_m = 0.0003;
  // Collapses with a larger rms error are never made [m].
  double max_error_m = 0.05;

  // An inner vertex may collapse onto a border vertex (which stays put);
  // otherwise rings of small triangles remain along dense borders.
  bool collapse_to_border = true;
  // Leave boundary edges of the mesh alone.
  bool keep_mesh_boundary = false;

  // Quadrics: share of the plane of the cluster against that of the face, in
  // [0, 1]: 1 draws vertices into the planes and to where planes meet, 0 to the
  // dense surface. A face at the distance d from its plane has the share
  //   cluster_plane_share / (1 + (d / plane_reach_m)^2),
  // so that what does not lie on the plane keeps its shape; 0 = the same at any
  // distance.
  double cluster_plane_share = 0.8;
  double plane_reach_m = 0.005;
  // Weights of the squared edge lengths of the lines along borders; share of
  // the mean face area that anchors vertices to themselves.
  double cluster_border_weight = 0.05;
  double mesh_boundary_weight = 0.3;
  double point_share = 1e-5;

  // Shape of a collapse, for each face that survives it: share of the present
  // height that must remain; largest turn of the normal; largest angle to the
  // mean normal of the dense surface that its corners stand for, or not larger
  // than now; compactness 4 sqrt(3) area / (l1^2 + l2^2 + l3^2), or not smaller
  // than now. A collapse that breaks one of the last three, but turns no normal
  // by 89 degrees and leaves a compactness of 2e-4, counts as shape_penalty
  // times as costly, in squared error (>= 1); 0: it is never made.
  double min_height_share = 1e-3;
  double max_turn_deg = 80;
  double max_away_deg = 80;
  double min_compactness = 0.02;
  double shape_penalty = 3;
};

struct SimplifyReport {
  int faces_before = 0, faces_after = 0;
  int border_edges_before = 0, border_edges_after = 0;
  int collapses = 0;
  double max_error_m = 0;  // largest rms error of a collapse that was made
  MeshChecks checks_before, checks_after;
  FlippedFaces flipped_before, flipped_after;
};

struct SimplifyResult {
  TriMesh mesh;
  // Same ids; face_cluster and num_faces of the new faces. Planes, centroids,
  // areas and rms remain those of the dense clusters: they rest on many more
  // samples. Every cluster keeps at least one face.
  PlanarPartition partition;
  std::vector<PlaneCluster> refit;  // the same, fitted to the new faces
  std::vector<int> vertex_birth;    // vertex of the input that became this one
  SimplifyReport report;
};

// `mesh` must be manifold (SplitNonManifold of mesh/clean.h makes it so) and
// `partition` must label every face. Manifold in, manifold out: components,
// boundary loops and Euler number stay as they are. Throws OptionsError;
// UnsolvableError if the mesh is not manifold. Runs on all threads
// (util/parallel_for.h); the result does not depend on their number.
SimplifyResult SimplifyByPlanes(const TriMesh& mesh,
                                const PlanarPartition& partition,
                                const SimplifyOptions& options);

}  // namespace facet
