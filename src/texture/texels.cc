// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "texture/texels.h"

#include <algorithm>

#include "texture/atlas.h"
#include "util/errors.h"
#include "util/parallel_for.h"

namespace facet {
namespace {

// First sampled column (or row) of `size` of them: samples lie centred, and
// charts narrower than the stride still get one.
int FirstSample(int size, int stride) { return ((size - 1) % stride) / 2; }

TexelSet SampleChart(const TriMesh& mesh,
                     const Atlas& atlas,
                     int chart_id,
                     int stride) {
  const Chart& chart = atlas.charts[chart_id];
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
                      const PlanarPartition& /*partition*/,
                      const Atlas& atlas,
                      int stride) {
  if (stride < 1) throw OptionsError("texel stride must be at least 1");
  std::vector<TexelSet> of_chart(atlas.charts.size());
  ParallelFor(0, atlas.charts.size(), [&](size_t c) {
    const Chart& chart = atlas.charts[c];
    if (chart.steep || chart.back) return;
    of_chart[c] = SampleChart(mesh, atlas, static_cast<int>(c), stride);
  });
  TexelSet texels;
  texels.spacing_m = atlas.spacing_m;
  texels.stride = stride;
  for (const TexelSet& part : of_chart) {
    Append(part.position, &texels.position);
    Append(part.plane, &texels.plane);
    Append(part.face, &texels.face);
    Append(part.bary, &texels.bary);
  }
  return texels;
}

}  // namespace facet
