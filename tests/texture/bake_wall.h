// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The scene of the tests of TextureBaker.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "tests/texture/memory_sequence.h"
#include "tests/texture/texture_scenes.h"
#include "texture/bake.h"
#include "texture/textured_mesh.h"

namespace facet {

// A wall of 0.15 x 0.12 m at z = 0.5 whose colour is linear in x and y: 3.5
// grey values a texel, so that a shift by half a texel shows.
inline Eigen::Vector3d Paint(const Eigen::Vector3d& x) {
  return {128 + 1400 * x.x(), 128 + 1400 * x.y(), 128 - 700 * x.x()};
}
inline cv::Vec3b Pixel(const Eigen::Vector3d& x) {
  const Eigen::Vector3d c = Paint(x);
  return {cv::saturate_cast<uint8_t>(c[0]),
          cv::saturate_cast<uint8_t>(c[1]),
          cv::saturate_cast<uint8_t>(c[2])};
}

class Wall {
 public:
  explicit Wall(int num_frames = 3) : sequence(TestCalibration()) {
    AddQuadGrid(Eigen::Vector3d(-0.075, -0.06, 0.5),
                Eigen::Vector3d(0.15, 0, 0),
                Eigen::Vector3d(0, 0.12, 0),
                3,
                2,
                &scene);
    atlas = BuildAtlas(scene.mesh, scene.partition, {});
    for (int i = 0; i < num_frames; ++i) {
      Add(Pose(Eigen::Quaterniond(Eigen::AngleAxisd(
                   0.04 * i, Eigen::Vector3d(1, 2, 0.5).normalized())),
               Eigen::Vector3d(0.01 * i, -0.02 * i, 0.02 * i)));
    }
    // The wall is small.
    visibility.test_depth_edges = visibility.test_mesh_edges = false;
    visibility.image_margin_px = 0;
    options.border_feather_px = 0;
    lattice = {20, 16, 320, 240};
  }

  // The images continue beyond the wall, so that gutters have a right answer.
  void Add(const Pose& pose) {
    const TriMesh wide = WideWall();
    sequence.AddRendered(wide, pose, Pixel);
  }

  TriMesh WideWall() const {
    PlaneScene wide;
    AddQuadGrid(Eigen::Vector3d(-1, -1, 0.5),
                Eigen::Vector3d(2, 0, 0),
                Eigen::Vector3d(0, 2, 0),
                1,
                1,
                &wide);
    return wide.mesh;
  }

  std::vector<cv::Mat> Bake(const std::vector<double>& warps = {}) {
    const auto frames = sequence.AllFrames();
    KeyframeImages images = LoadKeyframeColors(sequence, frames);
    images.exposures = exposures;
    const std::vector<Plane> planes = scene.Planes();
    const std::vector<Pose> poses = sequence.AllPoses();
    const TextureState state = {scene.mesh, planes, images, poses, warps};
    const RayScene rays(scene.mesh);
    const TextureBaker baker(
        state, atlas, rays, sequence, frames, lattice, visibility, options);
    if (!only_faces.empty()) return baker.BakeAs(state, only_faces, &report);
    return baker.Bake(&report);
  }

  TexturedMesh Model(const std::vector<cv::Mat>& pages) const {
    TexturedMesh model;
    model.mesh = scene.mesh;
    model.face_uv = atlas.face_uv;
    model.face_page = atlas.face_page;
    model.pages = pages;
    return model;
  }

  // Largest |page - paint| over the texels up to `ring` px outside the faces.
  double LargestError(const cv::Mat& page, int ring) const {
    const Chart& chart = atlas.charts[0];
    double worst = 0;
    for (int y = atlas.gutter_px - ring;
         y < chart.height - atlas.gutter_px + ring;
         ++y) {
      for (int x = atlas.gutter_px - ring;
           x < chart.width - atlas.gutter_px + ring;
           ++x) {
        const Eigen::Vector3d q =
            chart.origin +
            atlas.spacing_m * ((x + 0.5) * chart.e1 + (y + 0.5) * chart.e2);
        const auto& c = page.at<cv::Vec3b>(chart.y + y, chart.x + x);
        const Eigen::Vector3d right = Paint(q);
        for (int k = 0; k < 3; ++k) {
          worst = std::max(worst, std::abs(c[k] - right[k]));
        }
      }
    }
    return worst;
  }

  PlaneScene scene;
  Atlas atlas;
  MemorySequence sequence;
  VisibilityOptions visibility;
  BakeOptions options;
  std::vector<Exposure> exposures;
  WarpLattice lattice;
  BakeReport report;
  std::vector<char> only_faces;
};

}  // namespace facet
