// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// A textured room corner and a camera that looks into it: enough depth
// variation and texture for all six degrees of freedom to show.
#pragma once

#include <cmath>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "eval/photometric_metrics.h"

namespace facet {

inline Pinhole SmallCamera() { return {140, 140, 79.5, 59.5, 160, 120}; }

// Band-limited noise: its gradients survive bilinear lookups.
inline cv::Mat NoisePage(int size, uint64_t seed) {
  cv::Mat page(size, size, CV_8UC3);
  cv::RNG random(seed);
  random.fill(page, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(page, page, {0, 0}, 3);
  cv::normalize(page, page, 30, 220, cv::NORM_MINMAX);
  return page;
}

// A square patch with its own page.
inline void AddQuad(const Eigen::Vector3d& corner,
                    const Eigen::Vector3d& along_x,
                    const Eigen::Vector3d& along_y,
                    const cv::Mat& page,
                    TexturedMesh* model) {
  const int v = static_cast<int>(model->mesh.NumVertices());
  const float w = page.cols, h = page.rows;
  for (const auto& p : {corner,
                        Eigen::Vector3d(corner + along_x),
                        Eigen::Vector3d(corner + along_x + along_y),
                        Eigen::Vector3d(corner + along_y)}) {
    model->mesh.vertices.push_back(p);
  }
  model->mesh.faces.push_back({v, v + 1, v + 2});
  model->mesh.faces.push_back({v, v + 2, v + 3});
  model->face_uv.push_back(
      {Eigen::Vector2f(0, 0), Eigen::Vector2f(w, 0), Eigen::Vector2f(w, h)});
  model->face_uv.push_back(
      {Eigen::Vector2f(0, 0), Eigen::Vector2f(w, h), Eigen::Vector2f(0, h)});
  for (int k = 0; k < 2; ++k) {
    model->face_page.push_back(static_cast<int>(model->pages.size()));
  }
  model->pages.push_back(page);
}

// Back wall at z = 2 m, side wall at x = 0.8 m, floor at y = 0.6 m.
inline TexturedMesh Corner() {
  TexturedMesh model;
  AddQuad({-3, -3, 2}, {6, 0, 0}, {0, 6, 0}, NoisePage(512, 1), &model);
  AddQuad({0.8, -3, 2}, {0, 0, -4}, {0, 6, 0}, NoisePage(512, 2), &model);
  AddQuad({-3, 0.6, 2}, {6, 0, 0}, {0, 0, -4}, NoisePage(512, 3), &model);
  return model;
}

inline cv::Mat AsPhoto(const ModelView& view) {
  cv::Mat photo;
  view.color.convertTo(photo, CV_8U);
  return photo;
}

}  // namespace facet
