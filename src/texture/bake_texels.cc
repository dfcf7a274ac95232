// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "texture/bake_texels.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "util/parallel_for.h"

namespace facet {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr uint32_t kNone = std::numeric_limits<uint32_t>::max();

// For every pixel of a chart the owned pixel it belongs to (itself, or the one
// its gutter ring started from), -1 = none.
std::vector<int> RootPixels(const std::vector<int>& owners,
                            int width,
                            int height,
                            int ring_px) {
  std::vector<int> root(owners.size(), -1);
  std::vector<int> front;
  for (size_t i = 0; i < owners.size(); ++i) {
    if (owners[i] < 0) continue;
    root[i] = static_cast<int>(i);
    front.push_back(static_cast<int>(i));
  }
  // Straight neighbours first: their source is nearer.
  const int steps[8][2] = {
      {-1, 0}, {1, 0}, {0, -1}, {0, 1}, {-1, -1}, {1, -1}, {-1, 1}, {1, 1}};
  for (int ring = 0; ring < ring_px; ++ring) {
    std::vector<int> next;
    for (const auto& step : steps) {
      for (int i : front) {
        const int col = i % width + step[0], row = i / width + step[1];
        if (col < 0 || row < 0 || col >= width || row >= height) continue;
        const int j = row * width + col;
        if (root[j] >= 0) continue;
        root[j] = root[i];
        next.push_back(j);
      }
    }
    front.swap(next);
  }
  return root;
}

Vector3d PointOnFace(const TriMesh& mesh, int face, const Vector2d& b) {
  const auto& f = mesh.faces[face];
  return (1 - b.x() - b.y()) * mesh.vertices[f[0]] +
         b.x() * mesh.vertices[f[1]] + b.y() * mesh.vertices[f[2]];
}

// On the atlas, as all that says which texels there are.
int LargestFace(const Atlas& atlas, const Chart& chart) {
  const auto area = [&](int face) {
    const UvTriangle uv = atlas.ChartUv(face);
    const Vector2d a = uv[1] - uv[0], b = uv[2] - uv[0];
    return std::abs(a.x() * b.y() - a.y() * b.x());
  };
  return *std::max_element(chart.faces.begin(),
                           chart.faces.end(),
                           [&](int a, int b) { return area(a) < area(b); });
}

class ChartTexelizer {
 public:
  ChartTexelizer(const TriMesh& mesh,
                 const std::vector<Plane>& planes,
                 const Atlas& atlas,
                 int chart_id,
                 int ring_px,
                 int share_px)
      : mesh_(mesh),
        plane_(planes[atlas.charts[chart_id].plane]),
        atlas_(atlas),
        chart_(atlas.charts[chart_id]),
        chart_id_(chart_id),
        ring_px_(ring_px),
        share_px_(share_px) {}

  BakeTexels Run() {
    owners_ = ChartOwners(atlas_, chart_id_);
    bool any = false;
    for (int owner : owners_) any |= owner >= 0;
    if (!any) OwnOnePixel();
    const std::vector<int> roots =
        RootPixels(owners_, chart_.width, chart_.height, ring_px_);
    const int columns = (chart_.width + kBakeTilePx - 1) / kBakeTilePx;
    const int rows = (chart_.height + kBakeTilePx - 1) / kBakeTilePx;
    std::vector<std::vector<uint32_t>> owned(columns * rows), ring(owned);
    for (size_t i = 0; i < roots.size(); ++i) {
      if (roots[i] < 0) continue;
      const int tile = roots[i] / chart_.width / kBakeTilePx * columns +
                       roots[i] % chart_.width / kBakeTilePx;
      const auto pixel = static_cast<uint32_t>(i);
      (roots[i] == static_cast<int>(i) ? owned : ring)[tile].push_back(pixel);
    }
    std::vector<uint32_t> index(roots.size(), 0);
    for (size_t t = 0; t < owned.size(); ++t) {
      if (owned[t].empty()) continue;
      BakeTile tile;
      tile.chart = chart_id_;
      tile.begin = static_cast<uint32_t>(texels_.size());
      first_of_square_.assign(kBakeTilePx * kBakeTilePx, kNone);
      for (uint32_t pixel : owned[t]) {
        index[pixel] = static_cast<uint32_t>(texels_.size());
        AddOwned(pixel);
      }
      tile.owned_end = static_cast<uint32_t>(texels_.size());
      for (uint32_t pixel : ring[t]) AddRing(pixel, index[roots[pixel]]);
      tile.end = static_cast<uint32_t>(texels_.size());
      texels_.tiles.push_back(tile);
    }
    return std::move(texels_);
  }

 private:
  void OwnOnePixel() {
    const int face = LargestFace(atlas_, chart_);
    const UvTriangle uv = atlas_.ChartUv(face);
    const Vector2d middle = (uv[0] + uv[1] + uv[2]) / 3;
    const int col =
        std::clamp(static_cast<int>(middle.x()), 0, chart_.width - 1);
    const int row =
        std::clamp(static_cast<int>(middle.y()), 0, chart_.height - 1);
    owners_[static_cast<size_t>(row) * chart_.width + col] = face;
  }

  void AddOwned(uint32_t pixel) {
    const int face = owners_[pixel];
    const Vector2d center(pixel % chart_.width + 0.5,
                          pixel / chart_.width + 0.5);
    const Vector3d p =
        PointOnFace(mesh_, face, UvBarycentrics(atlas_.ChartUv(face), center));
    const Vector3d q = chart_.steep ? p : plane_.Project(p);
    texels_.p.push_back(p.cast<float>());
    texels_.q.push_back(q.cast<float>());
    texels_.pixel.push_back(pixel);
    texels_.source.push_back(SourceOf(pixel, face));
    texels_.face.push_back(face);
  }

  uint32_t SourceOf(uint32_t pixel, int face) {
    const auto self = static_cast<uint32_t>(texels_.source.size());
    const uint32_t column = pixel % chart_.width % kBakeTilePx / share_px_;
    const uint32_t row = pixel / chart_.width % kBakeTilePx / share_px_;
    uint32_t& first = first_of_square_[row * kBakeTilePx + column];
    if (first == kNone) first = self;
    return chart_.steep && first != self && texels_.face[first] != face ? self
                                                                        : first;
  }

  // `root` is an owned texel.
  void AddRing(uint32_t pixel, uint32_t root) {
    const int width = chart_.width;
    const int from = static_cast<int>(texels_.pixel[root]);
    const int to = static_cast<int>(pixel);
    const Vector3d offset =
        atlas_.spacing_m * ((to % width - from % width) * chart_.e1 +
                            (to / width - from / width) * chart_.e2);
    texels_.p.push_back(texels_.p[root] + offset.cast<float>());
    texels_.q.push_back(texels_.q[root] + offset.cast<float>());
    texels_.pixel.push_back(pixel);
    texels_.source.push_back(texels_.source[root]);
    texels_.face.push_back(texels_.face[root]);
  }

  const TriMesh& mesh_;
  const Plane plane_;
  const Atlas& atlas_;
  const Chart& chart_;
  const int chart_id_;
  const int ring_px_;
  const int share_px_;
  std::vector<int> owners_;
  // Of the current tile: the first owned texel of every square.
  std::vector<uint32_t> first_of_square_;
  BakeTexels texels_;
};

template <typename T>
void Append(const std::vector<T>& from, std::vector<T>* to) {
  to->insert(to->end(), from.begin(), from.end());
}

// Charts are made in batches of about so many pixels, so that only one of them
// stands beside the whole. Enough for many threads.
constexpr size_t kBatchPixels = 1 << 21;

size_t NumPixels(const Chart& chart) {
  return static_cast<size_t>(chart.width) * chart.height;
}

size_t EndOfBatch(const Atlas& atlas, size_t begin) {
  size_t end = begin, pixels = 0;
  while (end < atlas.charts.size() && pixels < kBatchPixels) {
    pixels += NumPixels(atlas.charts[end++]);
  }
  return end;
}

void AppendChart(BakeTexels part, BakeTexels* all) {
  const auto base = static_cast<uint32_t>(all->size());
  all->chart_tiles.push_back(static_cast<uint32_t>(all->tiles.size()));
  for (BakeTile tile : part.tiles) {
    tile.begin += base;
    tile.owned_end += base;
    tile.end += base;
    all->tiles.push_back(tile);
  }
  for (uint32_t& source : part.source) source += base;
  Append(part.p, &all->p);
  Append(part.q, &all->q);
  Append(part.pixel, &all->pixel);
  Append(part.source, &all->source);
  Append(part.face, &all->face);
}

}  // namespace

BakeTexels MakeBakeTexels(const TriMesh& mesh,
                          const std::vector<Plane>& planes,
                          const Atlas& atlas,
                          int ring_px,
                          int share_px) {
  size_t most = 0;
  for (const Chart& chart : atlas.charts) most += NumPixels(chart);
  BakeTexels all;
  // More than there will be, but what is not written to takes no memory.
  all.p.reserve(most);
  all.q.reserve(most);
  all.pixel.reserve(most);
  all.source.reserve(most);
  all.face.reserve(most);
  for (size_t begin = 0, end; begin < atlas.charts.size(); begin = end) {
    end = EndOfBatch(atlas, begin);
    std::vector<BakeTexels> batch(end - begin);
    ParallelFor(0, batch.size(), [&](size_t i) {
      const int chart = static_cast<int>(begin + i);
      batch[i] =
          ChartTexelizer(mesh, planes, atlas, chart, ring_px, share_px).Run();
    });
    for (BakeTexels& part : batch) AppendChart(std::move(part), &all);
  }
  all.chart_tiles.push_back(static_cast<uint32_t>(all.tiles.size()));
  return all;
}

std::vector<Eigen::Vector3f> MakeBakePoints(const TriMesh& mesh,
                                            const std::vector<Plane>& planes,
                                            const Atlas& atlas,
                                            int ring_px,
                                            int share_px,
                                            const BakeTexels& texels) {
  std::vector<Eigen::Vector3f> points(texels.size());
  ParallelFor(0, atlas.charts.size(), [&](size_t c) {
    const BakeTexels part =
        ChartTexelizer(
            mesh, planes, atlas, static_cast<int>(c), ring_px, share_px)
            .Run();
    const BakeTile& first = texels.tiles[texels.chart_tiles[c]];
    std::copy(part.q.begin(), part.q.end(), points.begin() + first.begin);
  });
  return points;
}

}  // namespace facet
