// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The texture atlas: charts of all clusters placed on pages (method, Sec. 4.2
// to 4.5). Built once from the simplified mesh; moving the vertices later keeps
// it valid (texture coordinates stay).
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "mesh/planar_partition.h"
#include "mesh/tri_mesh.h"
#include "texture/charts.h"

namespace facet {

struct AtlasOptions {
  double texel_size_m = 0.0025;  // h > 0; paper: 0.0025
  int page_size = 4096;          // largest width and height of a page [px]
  int gutter_px = 8;  // around every chart; 8 suffice for 3 mip levels
  double min_front_cos = 0.17;   // charts.h
  double steep_group_cos = 0.5;  // charts.h
};

struct Atlas {
  double spacing_m = 0;  // h [m]
  int gutter_px = 0;
  std::vector<Chart> charts;  // ascending plane
  // Texture coordinates of each corner, page px as in textured_mesh.h.
  std::vector<std::array<Eigen::Vector2f, 3>> face_uv;
  std::vector<int> face_page, face_chart;
  std::vector<std::array<int, 2>> page_size;  // width, height [px]

  // Faces that are not simply seen along their plane's normal (Sec. 4.4).
  size_t num_folded_charts = 0, num_folded_faces = 0;
  size_t num_steep_charts = 0, num_steep_faces = 0;
  size_t num_back_charts = 0, num_back_faces = 0;
  double folded_area_m2 = 0, steep_area_m2 = 0, back_area_m2 = 0;
  double fill = 0;  // share of the pages covered by charts with gutters

  // Corners in the pixels of the face's own chart.
  UvTriangle ChartUv(int face) const;
};

// Every face of the mesh gets texture coordinates. Charts larger than a page
// are split; a single face larger than a page makes larger pages (warning).
// Throws OptionsError for options out of range, UnsolvableError when a face
// would be larger than 65000 px.
Atlas BuildAtlas(const TriMesh& mesh,
                 const PlanarPartition& partition,
                 const AtlasOptions& options);

// The face whose triangle holds each texel centre of a chart, row-major
// width x height, -1 = none. A texel has one owner: the first of chart.faces.
std::vector<int> ChartOwners(const Atlas& atlas, int chart);

}  // namespace facet
