// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Charts: pieces of a cluster that a flat picture can show without overlap
// (method, Sec. 4.2 and 4.4).
//
// Projection onto the plane of a cluster is not injective where faces stand on
// it steeply, are turned over or fold above each other. With k = n_face . n:
//   k >= min_front_cos   front charts, seen along the plane's normal n;
//   k <= -min_front_cos  back charts, seen along -n;
//   between              steep charts, seen along the normal of their largest
//                        face; their faces stay within steep_group_cos of it.
// A chart grows over shared edges, large faces first, and takes a face only if
// none of the face's texels is taken yet in this chart.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "mesh/planar_partition.h"
#include "mesh/tri_mesh.h"
#include "texture/rasterize.h"

namespace facet {

// Chart coordinates [px] of a point v: x = e1.(v - origin) / h, y likewise with
// e2; the chart covers [0, width] x [0, height], gutter included. The outward
// normal is e2 x e1: with y down, the picture is not mirrored.
struct Chart {
  int plane = 0;                                     // cluster id
  std::vector<int> faces;                            // ascending
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  // world [m]
  Eigen::Vector3d e1 = Eigen::Vector3d::UnitX();
  Eigen::Vector3d e2 = Eigen::Vector3d::UnitY();
  int width = 0, height = 0;   // [px], gutter included
  int page = 0, x = 0, y = 0;  // upper left corner on its page [px]
  bool steep = false;          // own projection, not the plane's
  bool back = false;           // seen along -n of the plane
  bool folded = false;         // exists holds faces that overlapped others

  Eigen::Vector3d Normal() const { return e2.cross(e1); }
  Eigen::Vector2d ToPixel(const Eigen::Vector3d& v, double spacing_m) const {
    const Eigen::Vector3d d = (v - origin) / spacing_m;
    return {e1.dot(d), e2.dot(d)};
  }
};

struct ChartOptions {
  double texel_size_m = 0.0025;  // h; paper: 0.0025
  int gutter_px = 8;             // empty border on every side
  double min_front_cos = 0.17;   // cos 80 deg
  double steep_group_cos = 0.5;  // of steep faces with their chart's normal
  int max_size_px = 4096;        // larger charts are split by face centroids
};

// For every face the faces across edges (v0,v1), (v1,v2), (v2,v0) in the same
// cluster; -1 = none. Where more than two meet, each sees one other.
std::vector<std::array<int, 3>> ClusterNeighbors(
    const TriMesh& mesh, const std::vector<int>& face_cluster);

// The charts of one cluster, unplaced. Throws UnsolvableError for a plane of
// more than 2^31 texels. `faces` are its faces, ascending. A
// chart of a single face may exceed max_size_px.
std::vector<Chart> BuildClusterCharts(
    const TriMesh& mesh,
    const std::vector<std::array<int, 3>>& neighbors,
    const PlaneCluster& cluster,
    int cluster_id,
    const std::vector<int>& faces,
    const ChartOptions& options);

// Direction of a side of the smallest rectangle around the points; x for fewer
// than two different points.
Eigen::Vector2d MinAreaRectangleAxis(std::vector<Eigen::Vector2d> points);

}  // namespace facet
