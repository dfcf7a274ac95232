// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// One plane patch, one camera and an image for the tests of the photometric
// costs, in the double form of the reference and in the kernel's float form.
#pragma once

#include <vector>

#include "costs/frame_cell_cost.h"
#include "costs/photometric.h"
#include "costs/plane_manifold.h"
#include "costs/se3_manifold.h"
#include "util/random.h"

namespace facet {

// A row-major image with its view.
struct TestImage {
  std::vector<float> pixels;
  int width = 0, height = 0;
  ImageView<float> view() const {
    return {pixels.data(), width, height, width};
  }
};

// I = a + b x + c y + d x y with coefficients that floats hold exactly:
// bilinear interpolation reproduces it to the last bit of double, over all
// pixel cells, so that residuals are smooth and derivatives can be checked
// sharply.
inline TestImage BilinearImage(Random* random) {
  TestImage image;
  image.width = 160;
  image.height = 120;
  const auto dyadic = [&](int bits, int steps) {
    return (static_cast<double>(random->Index(2 * steps + 1)) - steps) /
           (1 << bits);
  };
  const double b = dyadic(14, 32) + 1.0 / (1 << 12);
  const double c = dyadic(14, 32) - 1.0 / (1 << 12);
  const double d = dyadic(20, 16);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      image.pixels.push_back(
          static_cast<float>(0.5 + b * x + c * y + d * x * y));
    }
  }
  return image;
}

inline TestImage NoiseImage(Random* random) {
  TestImage image;
  image.width = 160;
  image.height = 120;
  for (int i = 0; i < image.width * image.height; ++i) {
    image.pixels.push_back(static_cast<float>(random->Uniform()));
  }
  return image;
}

inline Eigen::Vector3d RandomVector(Random* random) {
  const double x = random->Normal(), y = random->Normal();
  return {x, y, random->Normal()};
}

// A patch 2 m before a camera that stands anywhere. p is off the plane by
// millimetres; q is its projection.
struct PhotoScene {
  Pinhole camera = {150, 155, 80.3, 58.6, 160, 120};
  WarpLattice lattice = {6, 5, 160, 120};
  std::vector<double> pose;   // 7
  std::vector<double> plane;  // 4, about anchor
  Eigen::Vector3d anchor, origin;
  std::vector<Eigen::Vector3d> p;
  std::vector<PhotoTexel> mesh_texels, plane_texels;  // about origin
  std::vector<uint32_t> ids;
  std::vector<double> warp;  // 2 * vertices [px]

  PhotoFrame Frame(const TestImage& image) const {
    PhotoFrame f;
    f.image = image.pixels.data();
    f.width = image.width;
    f.height = image.height;
    f.stride = image.width;
    f.fx = static_cast<float>(camera.fx);
    f.fy = static_cast<float>(camera.fy);
    f.cx = static_cast<float>(camera.cx);
    f.cy = static_cast<float>(camera.cy);
    f.columns = lattice.columns;
    f.rows = lattice.rows;
    f.inverse_cell_width = static_cast<float>(1 / lattice.CellWidth());
    f.inverse_cell_height = static_cast<float>(1 / lattice.CellHeight());
    SetFramePose(pose.data(), origin, &f);
    return f;
  }

  std::vector<double> Vertex(int column, int row) const {
    const double* f = warp.data() + 2 * lattice.VertexIndex(column, row);
    return {f[0], f[1]};
  }

  Eigen::Vector2d PixelOf(size_t i) const {
    const Eigen::Vector3d q = ProjectOntoPlane(plane.data(), p[i], anchor);
    return camera.Project<double>(PoseFromBlock(pose.data()) * q);
  }
};

inline PhotoScene MakePhotoScene(size_t num_texels, Random* random) {
  PhotoScene s;
  Vector6d xi;
  xi << RandomVector(random), 2 * RandomVector(random);
  const Pose cam_from_world = ExpSe3(xi);
  const Pose world_from_cam = cam_from_world.Inverse();
  s.pose.resize(kPoseSize);
  PoseToBlock(cam_from_world, s.pose.data());
  const Eigen::Vector3d normal_cam =
      (Eigen::Vector3d(0, 0, -1) + 0.3 * RandomVector(random)).normalized();
  const Eigen::Vector3d normal = world_from_cam.rotation * normal_cam;
  s.anchor = world_from_cam * Eigen::Vector3d(0.02, -0.03, 2.1);
  s.origin = s.anchor + 0.5 * RandomVector(random);
  s.plane = {normal.x(), normal.y(), normal.z(), 0.003};
  for (size_t i = 0; i < num_texels; ++i) {
    // The point of the plane on a random ray, moved off by the relief.
    const Eigen::Vector3d ray =
        world_from_cam.rotation *
        s.camera.Unproject(random->Uniform(35, 125), random->Uniform(30, 90));
    const Eigen::Vector3d c = cam_from_world.CenterInSource();
    const double depth =
        -(normal.dot(c - s.anchor) + s.plane[3]) / normal.dot(ray);
    const Eigen::Vector3d off =
        c + depth * ray + 0.004 * random->Normal() * normal;
    const float color = static_cast<float>(random->Uniform(0.3, 0.7));
    const Eigen::Vector3f mesh = (off - s.origin).cast<float>();
    s.p.push_back(mesh.cast<double>() + s.origin);
    const Eigen::Vector3f q =
        (ProjectOntoPlane(s.plane.data(), s.p.back(), s.anchor) - s.origin)
            .cast<float>();
    s.mesh_texels.push_back({mesh.x(), mesh.y(), mesh.z(), color});
    s.plane_texels.push_back({q.x(), q.y(), q.z(), color});
    s.ids.push_back(static_cast<uint32_t>(i));
  }
  for (int l = 0; l < 2 * s.lattice.NumVertices(); ++l) {
    s.warp.push_back(0.7 * random->Normal());
  }
  return s;
}

}  // namespace facet
