// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "texture/texels.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "mesh/edge_uses.h"
#include "texture/atlas.h"
#include "util/errors.h"
#include "util/parallel_for.h"

namespace facet {
namespace {

// First sampled column (or row) of `size` of them: samples lie centred, and
// charts narrower than the stride still get one.
int FirstSample(int size, int stride) { return ((size - 1) % stride) / 2; }

// Bit k of a face: its edge from corner k to the next is sharp.
std::vector<uint8_t> SharpEdges(const TriMesh& mesh,
                                const PlanarPartition& partition,
                                const TexelOptions& options) {
  std::vector<uint8_t> sharp(mesh.NumFaces(), 0);
  if (options.edge_margin_m == 0) return sharp;
  const double min_cos = std::cos(options.sharp_angle_deg * M_PI / 180);
  const std::vector<EdgeUse> uses = SortedEdgeUses(mesh);
  ForEachEdge(uses, [&](size_t begin, size_t end) {
    const int first = partition.face_cluster[uses[begin].Face()];
    const Plane& a = partition.clusters[first].plane;
    const Eigen::Vector3d middle = 0.5 * (mesh.vertices[uses[begin].low] +
                                          mesh.vertices[uses[begin].high]);
    bool is_sharp = end - begin == 1;
    for (size_t i = begin + 1; i < end; ++i) {
      const int other = partition.face_cluster[uses[i].Face()];
      if (other == first) continue;
      const Plane& b = partition.clusters[other].plane;
      is_sharp |= a.normal.dot(b.normal) < min_cos ||
                  std::abs(a.SignedDistance(middle)) +
                          std::abs(b.SignedDistance(middle)) >
                      options.sharp_step_m;
    }
    if (!is_sharp) return;
    for (size_t i = begin; i < end; ++i) {
      sharp[uses[i].Face()] |= static_cast<uint8_t>(1 << uses[i].corner % 3);
    }
  });
  return sharp;
}

// 255 where the pixels of a chart are within the margin of its sharp edges.
cv::Mat NearSharpEdges(const Atlas& atlas,
                       const Chart& chart,
                       const std::vector<uint8_t>& sharp,
                       double margin_px) {
  cv::Mat near = cv::Mat::zeros(chart.height, chart.width, CV_8U);
  constexpr int kBits = 4;  // of a pixel, in which cv::line takes places
  const int thickness = std::max(1, static_cast<int>(2 * margin_px + 0.5));
  const auto place = [](const Eigen::Vector2d& uv) {
    // Pixel centres of a chart lie at halves, those of OpenCV at integers.
    return cv::Point(static_cast<int>((uv.x() - 0.5) * (1 << kBits)),
                     static_cast<int>((uv.y() - 0.5) * (1 << kBits)));
  };
  for (const int face : chart.faces) {
    const UvTriangle uv = atlas.ChartUv(face);
    for (int k = 0; k < 3; ++k) {
      if ((sharp[face] >> k & 1) == 0) continue;
      cv::line(near,
               place(uv[k]),
               place(uv[(k + 1) % 3]),
               255,
               thickness,
               cv::LINE_8,
               kBits);
    }
  }
  return near;
}

TexelSet SampleChart(const TriMesh& mesh,
                     const Atlas& atlas,
                     int chart_id,
                     const std::vector<uint8_t>& sharp,
                     const TexelOptions& options) {
  const Chart& chart = atlas.charts[chart_id];
  const int stride = options.stride;
  const cv::Mat near = NearSharpEdges(
      atlas, chart, sharp, options.edge_margin_m / atlas.spacing_m);
  const std::vector<int> owners = ChartOwners(atlas, chart_id);
  const int gutter = atlas.gutter_px;
  TexelSet texels;
  const int row0 = gutter + FirstSample(chart.height - 2 * gutter, stride);
  const int col0 = gutter + FirstSample(chart.width - 2 * gutter, stride);
  for (int row = row0; row < chart.height - gutter; row += stride) {
    for (int col = col0; col < chart.width - gutter; col += stride) {
      const int face = owners[static_cast<size_t>(row) * chart.width + col];
      if (face < 0) continue;
      const Eigen::Vector2d b =
          UvBarycentrics(atlas.ChartUv(face), {col + 0.5, row + 0.5});
      const auto& f = mesh.faces[face];
      const Eigen::Vector3d p = (1 - b.x() - b.y()) * mesh.vertices[f[0]] +
                                b.x() * mesh.vertices[f[1]] +
                                b.y() * mesh.vertices[f[2]];
      if (near.at<uint8_t>(row, col) != 0) {
        texels.margin_position.push_back(p.cast<float>());
        texels.margin_plane.push_back(chart.plane);
        continue;
      }
      texels.position.push_back(p.cast<float>());
      texels.plane.push_back(chart.plane);
      texels.face.push_back(face);
      texels.bary.push_back(
          {static_cast<float>(b.x()), static_cast<float>(b.y())});
    }
  }
  return texels;
}

template <typename T>
void Append(const std::vector<T>& from, std::vector<T>* to) {
  to->insert(to->end(), from.begin(), from.end());
}

}  // namespace

TexelSet SampleTexels(const TriMesh& mesh,
                      const PlanarPartition& partition,
                      const Atlas& atlas,
                      const TexelOptions& options) {
  if (options.stride < 1) {
    throw OptionsError("texel stride must be at least 1");
  }
  if (!(options.edge_margin_m >= 0)) {
    throw OptionsError("the margin at sharp edges must not be negative");
  }
  const std::vector<uint8_t> sharp = SharpEdges(mesh, partition, options);
  std::vector<TexelSet> of_chart(atlas.charts.size());
  ParallelFor(0, atlas.charts.size(), [&](size_t c) {
    const Chart& chart = atlas.charts[c];
    if (chart.steep || chart.back) return;
    of_chart[c] = SampleChart(mesh, atlas, static_cast<int>(c), sharp, options);
  });
  TexelSet texels;
  texels.spacing_m = atlas.spacing_m;
  texels.stride = options.stride;
  for (const TexelSet& part : of_chart) {
    Append(part.position, &texels.position);
    Append(part.plane, &texels.plane);
    Append(part.face, &texels.face);
    Append(part.bary, &texels.bary);
    Append(part.margin_position, &texels.margin_position);
    Append(part.margin_plane, &texels.margin_plane);
  }
  return texels;
}

}  // namespace facet
