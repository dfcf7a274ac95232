// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Merging of adjacent clusters into planes (paper, Sec. 3.1; method, Sec. 2.7),
// and absorption of the islands that are left in larger planes (Sec. 2.6).
// Clusters i, j that share a mesh edge become one if three rules hold:
//
//   (1) angle(n_i, n_j) < eps_n                               NormalsAgree
//   (2) Avgdis(i, j) < eps_d and Avgdis(j, i) < eps_d         LieClose
//       Avgdis(i, j) = mean over the vertices v of i of |n_j.v + w_j|
//   (3) |r.n_i| < eps_c and |r.n_j| < eps_c, r = c_i - c_j    LieSideBySide
//       normalised: no parallel sheets on top of each other
//
// and if the union passes the guards against drift: pairwise tests alone would
// merge a cylinder strip by strip. Pairs are taken in the order of the growth
// of the cluster energy per smaller area, and tested again with the planes of
// the moment whenever one of the two has grown.
#pragma once

#include <cstddef>
#include <vector>

#include "mesh/cluster_energy.h"
#include "mesh/planar_partition.h"
#include "mesh/tri_mesh.h"

namespace facet {

struct MergeOptions {
  bool merge_planes = true;      // false: the islands only
  double max_normal_deg = 8;     // eps_n, in (0, 180]
  double max_distance_m = 0.05;  // eps_d, > 0
  double min_sheet_deg = 80;     // eps_c = cos of it, in [0, 90)

  // Guards. Largest rms distance of a union to its plane [m]; 0 = off.
  double max_rms_m = 0.03;
  // The normal of every original cluster stays within this factor x eps_n of
  // the union's; 0 = off.
  double max_drift_factor = 2;
  // Largest rms distance of any original cluster to the union's plane [m]; 0 =
  // off. Keeps thin things (a magazine on a table), which eps_d lets through
  // and which a large union outvotes.
  double max_member_rms_m = 0.008;

  // Opposite normals never merge: a door has two sides. Where the mesh is not
  // consistently oriented (over 5 % of its inner edges) they do, with a
  // warning.
  bool oriented_normals = true;
  // Rule 2 goes over the vertices until this many were visited, then over
  // the area: sqrt(mean square distance), which is larger, in constant time.
  size_t max_exact_distances = 10000000;

  // Islands: planes with at most this many neighbours...
  bool absorb_islands = true;
  int island_max_neighbors = 3;
  // ... of whose border edges this share lies between planes, not on the mesh
  // boundary, and this share of those along the same neighbour ...
  double island_border_share = 0.8;
  // ... which are small against it, or in themselves [m^2] ...
  double island_area_share = 0.01;
  double island_area_m2 = 0.0025;
  // ... and this close to its plane (rms, [m]), whatever their normals.
  double island_max_rms_m = 0.01;

  ClusterEnergyOptions energy;  // of the order of merging
};

struct MergeReport {
  int merges = 0;
  int islands = 0;  // absorbed
  // Tests that failed, by the first rule that did.
  int failed_normals = 0, failed_distance = 0, failed_sheet = 0,
      failed_guards = 0;
  bool oriented = true;  // were oriented normals used?
  double rms_m = 0;      // PartitionRms of the result
};

// Rule 1. `oriented` false compares the normals up to sign.
bool NormalsAgree(const Plane& a,
                  const Plane& b,
                  double max_normal_deg,
                  bool oriented);

// Rule 2, one way: mean |n.v + w| over the vertices listed [m]; 0 without any.
double MeanDistance(const std::vector<Eigen::Vector3d>& positions,
                    const std::vector<int>& vertices,
                    const Plane& plane);

// Rule 3. False for equal centroids.
bool LieSideBySide(const PlaneCluster& a,
                   const PlaneCluster& b,
                   double min_sheet_deg);

// The partition with merged clusters: ids 0 ... M-1 by decreasing area, planes
// refitted to all their faces. Throws OptionsError for senseless options.
// Deterministic, one thread.
PlanarPartition MergePlanes(const TriMesh& mesh,
                            const PlanarPartition& partition,
                            const MergeOptions& options,
                            MergeReport* report = nullptr);

}  // namespace facet
