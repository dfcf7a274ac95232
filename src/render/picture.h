// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Pictures of a mesh for people: the previews of a run. Two steps, because the
// rays cost more than the colours: SampleView casts them once, DrawView then
// colours the same hits as often as wanted (grey, by plane, textured before and
// after, with wireframe).
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "render/ray_scene.h"

namespace facet {

// 8-bit RGB, row-major, 3 bytes a pixel, no padding.
struct Picture {
  int width = 0, height = 0;
  std::vector<uint8_t> rgb;
};

// Where a picture is taken from.
struct PreviewView {
  std::string name;  // part of a file name, e.g. "above"
  Pinhole camera;
  Pose cam_from_world;
  // Look through faces seen from behind: a room opens to a view from outside.
  bool cull_back_faces = false;
};

// The first (front-facing) hit of supersampling^2 rays a pixel.
struct SampledView {
  PreviewView view;
  int supersampling = 1;
  std::vector<int> face;    // -1 = background; row-major on the finer raster
  std::vector<float> u, v;  // barycentrics as in RayHit
};

// `scene` must be built from `mesh`. All threads.
SampledView SampleView(const RayScene& scene,
                       const TriMesh& mesh,
                       const PreviewView& view,
                       int supersampling = 2);

// Colour of a surface point as RGB in [0, 1]; called on many threads.
using SurfaceColor =
    std::function<Eigen::Vector3f(int face, double u, double v)>;

SurfaceColor UniformColor(const Eigen::Vector3f& rgb);
// PlaneColor of the face's id; grey where the id is negative. The argument is
// copied.
SurfaceColor PlaneColors(const std::vector<int>& face_plane);
// Interpolated vertex colours. The mesh must outlive the result and carry
// colours.
SurfaceColor VertexColors(const TriMesh& mesh);

struct DrawOptions {
  // Multiply colours by the light of a lamp near the camera and some ambient
  // light: for grey and plane colours. Off for textures and vertex colours,
  // which carry the light of the scan.
  bool shade = true;
  // Shade with area-weighted vertex normals: for dense meshes. Off for light
  // ones, whose flat faces and creases are the point.
  bool smooth_normals = false;
  // Width of the drawn triangle edges [px of the picture]; 0 = none.
  double wireframe_px = 0;
  Eigen::Vector3f wireframe_rgb = {0.1f, 0.1f, 0.13f};
  // The background runs from the first colour (top) to the second one.
  Eigen::Vector3f background_top = {0.93f, 0.95f, 0.97f};
  Eigen::Vector3f background_bottom = {0.78f, 0.81f, 0.85f};
};

// Averages the samples of every pixel. `mesh` is the one that was sampled.
// Edges are drawn by the angle between a sample's ray and the plane through
// the camera centre and the edge, times the focal length: the distance in
// pixels, also for faces that reach behind the camera.
Picture DrawView(const SampledView& sampled,
                 const TriMesh& mesh,
                 const SurfaceColor& color,
                 const DrawOptions& options = DrawOptions());

}  // namespace facet
