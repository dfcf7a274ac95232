// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "texture/seam_vertices.h"

#include <algorithm>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <tuple>

#include "util/errors.h"
#include "util/parallel_for.h"

namespace facet {

SeamVertices SplitAtSeams(const TexturedMesh& model) {
  const auto& faces = model.mesh.faces;
  const auto corner = [&](size_t i) {
    const size_t face = i / 3, k = i % 3;
    SeamVertex v;
    v.vertex = faces[face][k];
    if (!model.face_page.empty()) v.page = model.face_page[face];
    if (!model.face_uv.empty()) v.uv = model.face_uv[face][k];
    return v;
  };
  const auto key = [&](size_t i) {
    const SeamVertex v = corner(i);
    return std::make_tuple(v.vertex, v.page, v.uv.x(), v.uv.y());
  };
  std::vector<size_t> order(3 * faces.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](size_t a, size_t b) {
    const auto ka = key(a), kb = key(b);
    return ka < kb || (ka == kb && a < b);
  });
  // The first corner of every group stands for all.
  std::vector<size_t> leader(order.size());
  for (size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && key(order[i]) == key(order[i - 1]);
    leader[order[i]] = same ? leader[order[i - 1]] : order[i];
  }
  SeamVertices result;
  result.corners.resize(faces.size());
  std::vector<int> id(order.size(), -1);
  for (size_t i = 0; i < order.size(); ++i) {
    int& mine = id[leader[i]];
    if (mine < 0) {
      mine = static_cast<int>(result.vertices.size());
      result.vertices.push_back(corner(i));
    }
    result.corners[i / 3][i % 3] = mine;
  }
  return result;
}

namespace {

std::string EncodePng(const cv::Mat& rgb) {
  cv::Mat bgr;
  cv::cvtColor(rgb, bgr, cv::COLOR_RGB2BGR);
  std::vector<unsigned char> bytes;
  if (!cv::imencode(".png", bgr, bytes, {cv::IMWRITE_PNG_COMPRESSION, 3})) {
    throw UnsolvableError("a texture page of " + std::to_string(rgb.cols) +
                          " x " + std::to_string(rgb.rows) +
                          " px cannot be encoded as PNG; use smaller pages");
  }
  return {bytes.begin(), bytes.end()};
}

}  // namespace

std::vector<std::string> EncodePages(const TexturedMesh& model) {
  std::vector<std::string> pages(model.pages.size());
  ParallelFor(0, pages.size(), [&](size_t page) {
    pages[page] = EncodePng(model.pages[page]);
  });
  return pages;
}

}  // namespace facet
