// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The pictures of a run: input, planes, light mesh, texture before and after,
// from three views (render/preview_views.h).
#pragma once

#include <string>
#include <vector>

#include "mesh/planar_partition.h"
#include "mesh/tri_mesh.h"
#include "render/preview_views.h"
#include "texture/textured_mesh.h"

namespace facet {

// Writes a picture as PNG, atomically.
void WritePng(const std::string& path, const Picture& picture);

// The rays of all views. `scene` must be built from `mesh`.
std::vector<SampledView> SampleViews(const RayScene& scene,
                                     const TriMesh& mesh,
                                     const std::vector<PreviewView>& views);

// By face: does any ray hit it?
std::vector<char> SeenFaces(const TriMesh& mesh,
                            const std::vector<SampledView>& views);

// The pictures of the dense mesh, from views around the poses of the colour
// camera: input_<view>.png (shaded), input_color_<view>.png when the mesh has
// colours, planes_<view>.png with its clusters in their colours. Returns the
// views.
std::vector<PreviewView> DrawDense(const std::string& dir,
                                   const TriMesh& mesh,
                                   const std::vector<int>& face_plane,
                                   const std::vector<Pose>& cam_from_world);

// wireframe_<view>.png: the light mesh, plane colours, triangle edges. Here and
// below `mesh` is the one that was sampled.
void DrawWireframe(const std::string& dir,
                   const std::vector<SampledView>& views,
                   const TriMesh& mesh,
                   const std::vector<int>& face_plane);

// <name>_<view>.png: with texture, unlit.
void DrawTextured(const std::string& dir,
                  const std::string& name,
                  const std::vector<SampledView>& views,
                  const TexturedMesh& model);

}  // namespace facet
