// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "texture/fill_texture.h"

#include <algorithm>
#include <cmath>

#include "util/parallel_for.h"

namespace facet {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3f;

struct PyramidLevel {
  int width = 0, height = 0;
  std::vector<float> weight;
  std::vector<Vector3f> color;
};

PyramidLevel Halve(const PyramidLevel& fine) {
  PyramidLevel coarse;
  coarse.width = (fine.width + 1) / 2;
  coarse.height = (fine.height + 1) / 2;
  const size_t size = static_cast<size_t>(coarse.width) * coarse.height;
  coarse.weight.assign(size, 0);
  coarse.color.assign(size, Vector3f::Zero());
  for (int y = 0; y < fine.height; ++y) {
    for (int x = 0; x < fine.width; ++x) {
      const size_t i = static_cast<size_t>(y) * fine.width + x;
      const size_t j = static_cast<size_t>(y / 2) * coarse.width + x / 2;
      coarse.weight[j] += fine.weight[i];
      coarse.color[j] += fine.weight[i] * fine.color[i];
    }
  }
  for (size_t j = 0; j < size; ++j) {
    if (!(coarse.weight[j] > 0)) continue;
    coarse.color[j] /= coarse.weight[j];
    coarse.weight[j] = std::min(coarse.weight[j], 1.0f);
  }
  return coarse;
}

// Fills what `fine` lacks from a complete coarser level, bilinearly.
void PullInto(const PyramidLevel& coarse, PyramidLevel* fine) {
  const auto split = [](int x, int size, int* x0, float* a) {
    const float center = std::clamp(
        (static_cast<float>(x) - 0.5f) / 2, 0.0f, static_cast<float>(size - 1));
    *x0 = std::min(static_cast<int>(center), std::max(size - 2, 0));
    *a = center - static_cast<float>(*x0);
  };
  for (int y = 0; y < fine->height; ++y) {
    for (int x = 0; x < fine->width; ++x) {
      const size_t i = static_cast<size_t>(y) * fine->width + x;
      if (fine->weight[i] > 0) continue;
      int x0, y0;
      float a, b;
      split(x, coarse.width, &x0, &a);
      split(y, coarse.height, &y0, &b);
      const int x1 = std::min(x0 + 1, coarse.width - 1);
      const int y1 = std::min(y0 + 1, coarse.height - 1);
      const auto at = [&](int cx, int cy) -> const Vector3f& {
        return coarse.color[static_cast<size_t>(cy) * coarse.width + cx];
      };
      fine->color[i] = (1 - b) * ((1 - a) * at(x0, y0) + a * at(x1, y0)) +
                       b * ((1 - a) * at(x0, y1) + a * at(x1, y1));
    }
  }
}

Vector3f InterpolateVertices(const TriMesh& mesh,
                             const Atlas& atlas,
                             int face,
                             const Vector2d& pixel,
                             const std::vector<Vector3f>& vertex_colors) {
  const Vector2d b = UvBarycentrics(atlas.ChartUv(face), pixel);
  const auto& f = mesh.faces[face];
  const float b1 = static_cast<float>(b.x()), b2 = static_cast<float>(b.y());
  return (1 - b1 - b2) * vertex_colors[f[0]] + b1 * vertex_colors[f[1]] +
         b2 * vertex_colors[f[2]];
}

// Replaces the colours of the unseen texels of one chart.
void InpaintChart(const TriMesh& mesh,
                  const Atlas& atlas,
                  int chart_id,
                  size_t begin,
                  size_t end,
                  const BakeTexels& texels,
                  const std::vector<uint8_t>& seen,
                  const std::vector<Vector3f>& vertex_colors,
                  std::vector<Vector3f>* colors) {
  const auto unseen = std::find(seen.begin() + static_cast<ptrdiff_t>(begin),
                                seen.begin() + static_cast<ptrdiff_t>(end),
                                0);
  if (unseen == seen.begin() + static_cast<ptrdiff_t>(end)) return;
  const Chart& chart = atlas.charts[chart_id];
  const size_t size = static_cast<size_t>(chart.width) * chart.height;
  std::vector<float> weight(size, 0);
  std::vector<Vector3f> difference(size, Vector3f::Zero());
  std::vector<Vector3f> base(end - begin);
  for (size_t i = begin; i < end; ++i) {
    const int pixel = static_cast<int>(texels.pixel[i]);
    base[i - begin] = InterpolateVertices(
        mesh,
        atlas,
        texels.face[i],
        Vector2d(pixel % chart.width + 0.5, pixel / chart.width + 0.5),
        vertex_colors);
    if (!seen[i]) continue;
    weight[pixel] = 1;
    difference[pixel] = (*colors)[i] - base[i - begin];
  }
  PushPull(chart.width, chart.height, weight, &difference);
  for (size_t i = begin; i < end; ++i) {
    if (seen[i]) continue;
    (*colors)[i] = (base[i - begin] + difference[texels.pixel[i]])
                       .cwiseMax(0)
                       .cwiseMin(255);
  }
}

// Copies the colours of one chart to its page and its outer gutter.
void WriteChart(const Chart& chart,
                int gutter_px,
                size_t begin,
                size_t end,
                const BakeTexels& texels,
                const std::vector<Vector3f>& colors,
                cv::Mat* page) {
  cv::Mat box = (*page)(cv::Rect(chart.x, chart.y, chart.width, chart.height));
  std::vector<uint8_t> set(static_cast<size_t>(chart.width) * chart.height, 0);
  std::vector<int> front;
  for (size_t i = begin; i < end; ++i) {
    const int pixel = static_cast<int>(texels.pixel[i]);
    uint8_t* out =
        box.ptr<uint8_t>(pixel / chart.width) + 3 * (pixel % chart.width);
    for (int k = 0; k < 3; ++k) {
      out[k] =
          static_cast<uint8_t>(std::clamp(std::lround(colors[i][k]), 0l, 255l));
    }
    set[pixel] = 1;
    front.push_back(pixel);
  }
  std::sort(front.begin(), front.end());
  const int steps[8][2] = {
      {-1, 0}, {1, 0}, {0, -1}, {0, 1}, {-1, -1}, {1, -1}, {-1, 1}, {1, 1}};
  for (int ring = 0; ring < gutter_px; ++ring) {
    std::vector<int> next;
    for (const auto& step : steps) {
      for (int i : front) {
        const int col = i % chart.width, row = i / chart.width;
        const int c = col + step[0], r = row + step[1];
        if (c < 0 || r < 0 || c >= chart.width || r >= chart.height) continue;
        const int j = r * chart.width + c;
        if (set[j]) continue;
        set[j] = 1;
        box.at<cv::Vec3b>(r, c) = box.at<cv::Vec3b>(row, col);
        next.push_back(j);
      }
    }
    front.swap(next);
  }
}

// [begin, end) of the texels of a chart.
std::pair<size_t, size_t> ChartRange(const BakeTexels& texels, size_t chart) {
  const uint32_t first = texels.chart_tiles[chart];
  const uint32_t last = texels.chart_tiles[chart + 1];
  if (first == last) return {0, 0};
  return {texels.tiles[first].begin, texels.tiles[last - 1].end};
}

}  // namespace

bool PushPull(int width,
              int height,
              const std::vector<float>& weight,
              std::vector<Vector3f>* color) {
  std::vector<PyramidLevel> levels;
  levels.push_back({width, height, weight, *color});
  while (levels.back().width > 1 || levels.back().height > 1) {
    levels.push_back(Halve(levels.back()));
  }
  if (!(levels.back().weight[0] > 0)) return false;
  for (size_t l = levels.size() - 1; l-- > 0;) {
    PullInto(levels[l + 1], &levels[l]);
  }
  *color = std::move(levels[0].color);
  return true;
}

std::vector<Vector3f> VertexBaseColors(const TriMesh& mesh,
                                       const BakeTexels& texels,
                                       const std::vector<uint8_t>& seen,
                                       const std::vector<Vector3f>& colors) {
  const size_t n = mesh.NumVertices();
  std::vector<Vector3f> base(n, Vector3f::Constant(128));
  if (mesh.vertex_colors.size() == n) {
    for (size_t v = 0; v < n; ++v) {
      for (int k = 0; k < 3; ++k) base[v][k] = mesh.vertex_colors[v][k];
    }
    return base;
  }
  std::vector<Eigen::Vector4d> sum(n, Eigen::Vector4d::Zero());
  for (const BakeTile& tile : texels.tiles) {
    for (uint32_t i = tile.begin; i < tile.owned_end; ++i) {
      if (!seen[i]) continue;
      const Vector3f& c = colors[i];
      for (int v : mesh.faces[texels.face[i]]) {
        sum[v] += Eigen::Vector4d(c.x(), c.y(), c.z(), 1);
      }
    }
  }
  std::vector<uint8_t> known(n, 0);
  Eigen::Vector4d all = Eigen::Vector4d::Zero();
  for (size_t v = 0; v < n; ++v) {
    all += sum[v];
    if (!(sum[v].w() > 0)) continue;
    base[v] = (sum[v].head<3>() / sum[v].w()).cast<float>();
    known[v] = 1;
  }
  // Rings of unknown vertices take the mean of their known neighbours.
  for (bool grown = true; grown;) {
    grown = false;
    std::vector<Eigen::Vector4f> ring(n, Eigen::Vector4f::Zero());
    for (const auto& f : mesh.faces) {
      for (int k = 0; k < 6; ++k) {
        const int to = f[k % 3], from = f[(k + 1 + k / 3) % 3];
        if (known[to] || !known[from]) continue;
        ring[to].head<3>() += base[from];
        ring[to].w() += 1;
      }
    }
    for (size_t v = 0; v < n; ++v) {
      if (!(ring[v].w() > 0)) continue;
      base[v] = ring[v].head<3>() / ring[v].w();
      known[v] = 1;
      grown = true;
    }
  }
  for (size_t v = 0; v < n; ++v) {
    if (!known[v] && all.w() > 0) {
      base[v] = (all.head<3>() / all.w()).cast<float>();
    }
  }
  return base;
}

std::vector<cv::Mat> FillPages(const TriMesh& mesh,
                               const Atlas& atlas,
                               const BakeTexels& texels,
                               const std::vector<uint8_t>& seen,
                               bool inpaint,
                               std::vector<Vector3f>* colors) {
  std::vector<cv::Mat> pages;
  for (const auto& size : atlas.page_size) {
    pages.emplace_back(size[1], size[0], CV_8UC3, cv::Scalar(128, 128, 128));
  }
  std::vector<Vector3f> vertex_colors;
  if (inpaint) vertex_colors = VertexBaseColors(mesh, texels, seen, *colors);
  ParallelFor(0, atlas.charts.size(), [&](size_t c) {
    const auto [begin, end] = ChartRange(texels, c);
    if (inpaint) {
      InpaintChart(mesh,
                   atlas,
                   static_cast<int>(c),
                   begin,
                   end,
                   texels,
                   seen,
                   vertex_colors,
                   colors);
    }
    const Chart& chart = atlas.charts[c];
    WriteChart(chart,
               atlas.gutter_px,
               begin,
               end,
               texels,
               *colors,
               &pages[chart.page]);
  });
  return pages;
}

std::vector<cv::Mat> UnseenMask(const Atlas& atlas,
                                const BakeTexels& texels,
                                const std::vector<uint8_t>& seen) {
  std::vector<cv::Mat> mask;
  for (const auto& size : atlas.page_size) {
    mask.emplace_back(size[1], size[0], CV_8U, cv::Scalar(0));
  }
  for (const BakeTile& tile : texels.tiles) {
    const Chart& chart = atlas.charts[tile.chart];
    for (uint32_t i = tile.begin; i < tile.owned_end; ++i) {
      if (seen[i]) continue;
      const int pixel = static_cast<int>(texels.pixel[i]);
      mask[chart.page].at<uint8_t>(chart.y + pixel / chart.width,
                                   chart.x + pixel % chart.width) = 255;
    }
  }
  return mask;
}

}  // namespace facet
