// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Rays against a triangle mesh, by Embree. The one owner of rays in facet:
// visibility, synthetic scans, evaluation and previews all ask here.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "geometry/pinhole.h"
#include "geometry/pose.h"
#include "mesh/tri_mesh.h"

namespace facet {

struct RayHit {
  int face = -1;          // -1 = nothing hit
  double t = 0;           // hit point = origin + t * direction
  double u = 0, v = 0;    // barycentrics: (1-u-v) v0 + u v1 + v v2
};

class RayScene {
 public:
  explicit RayScene(const TriMesh& mesh);  // copies what it needs
  ~RayScene();
  RayScene(const RayScene&) = delete;
  RayScene& operator=(const RayScene&) = delete;

  // First hit with t in (t_min, t_max). `direction` need not be unit length.
  RayHit Intersect(const Eigen::Vector3d& origin,
                   const Eigen::Vector3d& direction,
                   double t_min = 0,
                   double t_max = 1e30) const;

  // Is there any hit with t in (t_min, t_max)?
  bool Occluded(const Eigen::Vector3d& origin,
                const Eigen::Vector3d& direction,
                double t_min,
                double t_max) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Per-pixel hits of a camera, row-major.
struct DepthRender {
  int width = 0, height = 0;
  std::vector<float> depth;   // z in the camera [m]; 0 = nothing hit
  std::vector<int> face;      // -1 = nothing hit
  std::vector<float> u, v;    // barycentrics as in RayHit
};

// One ray a pixel centre, on all threads.
DepthRender RenderDepth(const RayScene& scene,
                        const Pinhole& camera,
                        const Pose& cam_from_world);

}  // namespace facet
