// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "texture/textured_mesh.h"

#include <algorithm>

namespace facet {
namespace {

Eigen::Vector3f ToVector(const cv::Vec3b& c) {
  return {static_cast<float>(c[0]),
          static_cast<float>(c[1]),
          static_cast<float>(c[2])};
}

Eigen::Vector3f VertexColorAt(const TriMesh& mesh, int face, float u, float v) {
  const std::array<int, 3>& f = mesh.faces[face];
  const float weight[3] = {1 - u - v, u, v};
  Eigen::Vector3f color = Eigen::Vector3f::Zero();
  for (int k = 0; k < 3; ++k) {
    const Rgb& c = mesh.vertex_colors[f[k]];
    color += weight[k] * Eigen::Vector3f(c[0], c[1], c[2]);
  }
  return color;
}

}  // namespace

Eigen::Vector3f ColorAt(const TexturedMesh& model, int face, float u, float v) {
  if (model.face_uv.empty()) return VertexColorAt(model.mesh, face, u, v);
  const std::array<Eigen::Vector2f, 3>& uv = model.face_uv[face];
  const cv::Mat& page = model.pages[model.face_page[face]];
  const Eigen::Vector2f p = (1 - u - v) * uv[0] + u * uv[1] + v * uv[2];
  const float x = std::clamp(p.x() - 0.5f, 0.0f, page.cols - 1.0f);
  const float y = std::clamp(p.y() - 0.5f, 0.0f, page.rows - 1.0f);
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  const int x1 = std::min(x0 + 1, page.cols - 1);
  const int y1 = std::min(y0 + 1, page.rows - 1);
  const float a = x - x0, b = y - y0;
  const cv::Vec3b* top = page.ptr<cv::Vec3b>(y0);
  const cv::Vec3b* bottom = page.ptr<cv::Vec3b>(y1);
  return (1 - b) * ((1 - a) * ToVector(top[x0]) + a * ToVector(top[x1])) +
         b * ((1 - a) * ToVector(bottom[x0]) + a * ToVector(bottom[x1]));
}

}  // namespace facet
