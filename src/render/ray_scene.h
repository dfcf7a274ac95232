// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Rays and nearest points against a triangle mesh, by Embree. The one owner of
// rays in facet: visibility, synthetic scans, evaluation and previews all ask
// here.
//
// Embree stores float32 vertices and traverses in its watertight ("robust")
// mode: no ray slips between two triangles that share an edge. Both sides of a
// triangle count. All queries are const and may run on many threads at once.
// Results do not depend on the number of threads, the choice between two faces
// that meet exactly in the hit point included.
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <vector>

#include "geometry/pinhole.h"
#include "geometry/pose.h"
#include "mesh/tri_mesh.h"

namespace facet {

struct RayHit {
  int face = -1;        // -1 = nothing hit
  double t = 0;         // hit point = origin + t * direction
  double u = 0, v = 0;  // barycentrics: (1-u-v) v0 + u v1 + v v2
};

struct NearestHit {
  int face = -1;        // -1 = nothing within the distance
  double distance = 0;  // from the query point [m]
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  // on the face [m]
  double u = 0, v = 0;                              // as in RayHit
};

class RayScene {
 public:
  // Copies what it needs. A mesh without faces is a valid, empty scene; faces
  // of zero area are never hit by rays.
  explicit RayScene(const TriMesh& mesh);
  ~RayScene();
  RayScene(const RayScene&) = delete;
  RayScene& operator=(const RayScene&) = delete;

  const std::vector<Eigen::Vector3d>& vertices() const;
  const std::vector<std::array<int, 3>>& faces() const;

  // First hit with t in (t_min, t_max). `direction` need not be unit length.
  // Embree finds the face in float32; t, u, v are then solved for in double.
  RayHit Intersect(const Eigen::Vector3d& origin,
                   const Eigen::Vector3d& direction,
                   double t_min = 0,
                   double t_max = 1e30) const;

  // Is there any hit with t in (t_min, t_max)?
  bool Occluded(const Eigen::Vector3d& origin,
                const Eigen::Vector3d& direction,
                double t_min,
                double t_max) const;

  // The point of the mesh closest to `point`, if one lies within
  // `max_distance` [m]; the exact minimum over all triangles, in double.
  NearestHit NearestPoint(const Eigen::Vector3d& point,
                          double max_distance = 1e30) const;

 private:
  friend struct RayPackets;
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// Per-pixel hits of a camera, row-major.
struct DepthRender {
  int width = 0, height = 0;
  std::vector<float> depth;  // z in the camera [m]; 0 = nothing hit
  std::vector<int> face;     // -1 = nothing hit
  std::vector<float> u, v;   // barycentrics as in RayHit
};

// One ray a pixel centre, on all threads. Accuracy is that of float32, about
// 1e-6 of the depth.
DepthRender RenderDepth(const RayScene& scene,
                        const Pinhole& camera,
                        const Pose& cam_from_world);

}  // namespace facet
