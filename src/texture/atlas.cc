// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "texture/atlas.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "texture/pack_rectangles.h"
#include "util/errors.h"
#include "util/parallel_for.h"
#include "util/warnings.h"

namespace facet {
namespace {

// Beyond this the integer rasteriser and image writers give up.
constexpr int kMaxPageSize = 65000;

void CheckOptions(const AtlasOptions& options) {
  if (!(options.texel_size_m > 0)) {
    throw OptionsError("texel size must be positive, e.g. 0.0025 m");
  }
  if (options.gutter_px < 1 || options.page_size < 64 ||
      options.page_size > 32768 || options.page_size <= 4 * options.gutter_px) {
    throw OptionsError(
        "texture pages must be 64 to 32768 px wide and more than four gutters "
        "(at least 1 px each); change the page size or the gutter");
  }
}

std::vector<std::vector<int>> FacesByCluster(const PlanarPartition& partition) {
  std::vector<std::vector<int>> faces(partition.clusters.size());
  for (size_t f = 0; f < partition.face_cluster.size(); ++f) {
    faces[partition.face_cluster[f]].push_back(static_cast<int>(f));
  }
  return faces;
}

int RoundUpToFour(int x) { return (x + 3) / 4 * 4; }

// Chooses the page format and places every chart.
void Place(int page_size, Atlas* atlas) {
  std::vector<PackedRectangle> rectangles(atlas->charts.size());
  int widest = 0, highest = 0;
  double area = 0;
  for (size_t c = 0; c < rectangles.size(); ++c) {
    rectangles[c].width = atlas->charts[c].width;
    rectangles[c].height = atlas->charts[c].height;
    widest = std::max(widest, rectangles[c].width);
    highest = std::max(highest, rectangles[c].height);
    area += 1.0 * rectangles[c].width * rectangles[c].height;
  }
  const int largest = std::max(widest, highest);
  if (largest > kMaxPageSize) {
    throw UnsolvableError(
        "a face of the mesh spans " + std::to_string(largest) +
        " texels, more than a picture can hold; raise the texel size");
  }
  if (largest > page_size) {
    AddWarning("a face of " + std::to_string(largest) +
               " texels does not fit a texture page of " +
               std::to_string(page_size) + " px: pages were enlarged");
    page_size = RoundUpToFour(largest);
  }
  // What fits one page gets one that is about square.
  const int square = RoundUpToFour(
      std::max(largest, static_cast<int>(std::sqrt(1.15 * area)) + 1));
  const int width = std::min(page_size, square);
  const int num_pages = PackRectangles(width, page_size, &rectangles);
  atlas->page_size.assign(num_pages, {4, 4});
  for (size_t c = 0; c < rectangles.size(); ++c) {
    Chart& chart = atlas->charts[c];
    chart.page = rectangles[c].page;
    chart.x = rectangles[c].x;
    chart.y = rectangles[c].y;
    auto& size = atlas->page_size[chart.page];
    size[0] = std::max(size[0], RoundUpToFour(chart.x + chart.width));
    size[1] = std::max(size[1], RoundUpToFour(chart.y + chart.height));
  }
  double page_area = 0;
  for (const auto& size : atlas->page_size)
    page_area += 1.0 * size[0] * size[1];
  atlas->fill = page_area > 0 ? area / page_area : 0;
}

void SetFaceUv(const TriMesh& mesh, Atlas* atlas) {
  atlas->face_uv.resize(mesh.NumFaces());
  atlas->face_page.assign(mesh.NumFaces(), 0);
  atlas->face_chart.assign(mesh.NumFaces(), -1);
  for (size_t c = 0; c < atlas->charts.size(); ++c) {
    const Chart& chart = atlas->charts[c];
    const Eigen::Vector2d corner(chart.x, chart.y);
    for (int face : chart.faces) {
      atlas->face_page[face] = chart.page;
      atlas->face_chart[face] = static_cast<int>(c);
      for (int k = 0; k < 3; ++k) {
        const Eigen::Vector2d p =
            chart.ToPixel(mesh.vertices[mesh.faces[face][k]], atlas->spacing_m);
        atlas->face_uv[face][k] = (p + corner).cast<float>();
      }
    }
  }
}

void Count(const TriMesh& mesh, Atlas* atlas) {
  for (const Chart& chart : atlas->charts) {
    double area = 0;
    for (int face : chart.faces) area += mesh.FaceArea(face);
    if (chart.steep) {
      ++atlas->num_steep_charts;
      atlas->num_steep_faces += chart.faces.size();
      atlas->steep_area_m2 += area;
    } else if (chart.back) {
      ++atlas->num_back_charts;
      atlas->num_back_faces += chart.faces.size();
      atlas->back_area_m2 += area;
    } else if (chart.folded) {
      ++atlas->num_folded_charts;
      atlas->num_folded_faces += chart.faces.size();
      atlas->folded_area_m2 += area;
    }
  }
}

}  // namespace

UvTriangle Atlas::ChartUv(int face) const {
  const Chart& chart = charts[face_chart[face]];
  UvTriangle uv;
  for (int k = 0; k < 3; ++k) {
    uv[k] = face_uv[face][k].cast<double>() - Eigen::Vector2d(chart.x, chart.y);
  }
  return uv;
}

Atlas BuildAtlas(const TriMesh& mesh,
                 const PlanarPartition& partition,
                 const AtlasOptions& options) {
  CheckOptions(options);
  Atlas atlas;
  atlas.spacing_m = options.texel_size_m;
  atlas.gutter_px = options.gutter_px;
  ChartOptions chart_options;
  chart_options.texel_size_m = options.texel_size_m;
  chart_options.gutter_px = options.gutter_px;
  chart_options.min_front_cos = options.min_front_cos;
  chart_options.steep_group_cos = options.steep_group_cos;
  chart_options.max_size_px = options.page_size;

  const auto neighbors = ClusterNeighbors(mesh, partition.face_cluster);
  const auto faces = FacesByCluster(partition);
  std::vector<std::vector<Chart>> charts(faces.size());
  ParallelFor(0, faces.size(), [&](size_t i) {
    charts[i] = BuildClusterCharts(mesh,
                                   neighbors,
                                   partition.clusters[i],
                                   static_cast<int>(i),
                                   faces[i],
                                   chart_options);
  });
  for (auto& of_cluster : charts) {
    for (Chart& chart : of_cluster) atlas.charts.push_back(std::move(chart));
  }
  Place(options.page_size, &atlas);
  SetFaceUv(mesh, &atlas);
  Count(mesh, &atlas);
  return atlas;
}

std::vector<int> ChartOwners(const Atlas& atlas, int chart_id) {
  const Chart& chart = atlas.charts[chart_id];
  std::vector<int> owners(static_cast<size_t>(chart.width) * chart.height, -1);
  for (int face : chart.faces) {
    RasterizeTriangle(
        atlas.ChartUv(face), chart.width, chart.height, [&](int col, int row) {
          int& owner = owners[static_cast<size_t>(row) * chart.width + col];
          if (owner < 0) owner = face;
        });
  }
  return owners;
}

}  // namespace facet
