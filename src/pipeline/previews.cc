// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "pipeline/previews.h"

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "util/atomic_file.h"
#include "util/errors.h"
#include "util/parallel_for.h"

namespace facet {
namespace {

void Draw(const std::string& dir,
          const std::string& name,
          const std::vector<SampledView>& views,
          const TriMesh& mesh,
          const SurfaceColor& color,
          const DrawOptions& options) {
  ParallelFor(0, views.size(), [&](size_t i) {
    WritePng(dir + "/" + name + "_" + views[i].view.name + ".png",
             DrawView(views[i], mesh, color, options));
  });
}

void DrawInput(const std::string& dir,
               const std::vector<SampledView>& views,
               const TriMesh& mesh) {
  DrawOptions options;
  options.smooth_normals = true;
  Draw(dir, "input", views, mesh, UniformColor({0.78f, 0.78f, 0.8f}), options);
  if (!mesh.vertex_colors.empty()) {
    options.shade = false;
    Draw(dir, "input_color", views, mesh, VertexColors(mesh), options);
  }
}

}  // namespace

void WritePng(const std::string& path, const Picture& picture) {
  const cv::Mat rgb(picture.height,
                    picture.width,
                    CV_8UC3,
                    const_cast<uint8_t*>(picture.rgb.data()));
  cv::Mat bgr;
  cv::cvtColor(rgb, bgr, cv::COLOR_RGB2BGR);
  WriteFileAtomically(path, [&](const std::string& temporary_path) {
    if (!cv::imwrite(temporary_path, bgr)) {
      throw InputError("cannot write " + path);
    }
  });
}

std::vector<SampledView> SampleViews(const RayScene& scene,
                                     const TriMesh& mesh,
                                     const std::vector<PreviewView>& views) {
  std::vector<SampledView> sampled;
  for (const PreviewView& view : views) {
    sampled.push_back(SampleView(scene, mesh, view));
  }
  return sampled;
}

std::vector<char> SeenFaces(const TriMesh& mesh,
                            const std::vector<SampledView>& views) {
  std::vector<char> seen(mesh.NumFaces(), 0);
  for (const SampledView& sampled : views) {
    for (const int face : sampled.face) {
      if (face >= 0) seen[face] = 1;
    }
  }
  return seen;
}

std::vector<PreviewView> DrawDense(const std::string& dir,
                                   const TriMesh& mesh,
                                   const std::vector<int>& face_plane,
                                   const std::vector<Pose>& cam_from_world) {
  const RayScene scene(mesh);
  const std::vector<PreviewView> views =
      ChooseViews(scene, mesh, cam_from_world);
  const std::vector<SampledView> sampled = SampleViews(scene, mesh, views);
  DrawInput(dir, sampled, mesh);
  Draw(dir, "planes", sampled, mesh, PlaneColors(face_plane), DrawOptions());
  return views;
}

void DrawWireframe(const std::string& dir,
                   const std::vector<SampledView>& views,
                   const TriMesh& mesh,
                   const std::vector<int>& face_plane) {
  DrawOptions options;
  options.wireframe_px = 1.0;
  Draw(dir, "wireframe", views, mesh, PlaneColors(face_plane), options);
}

void DrawTextured(const std::string& dir,
                  const std::string& name,
                  const std::vector<SampledView>& views,
                  const TexturedMesh& model) {
  DrawOptions options;
  options.shade = false;
  Draw(
      dir,
      name,
      views,
      model.mesh,
      [&](int face, double u, double v) -> Eigen::Vector3f {
        return ColorAt(
                   model, face, static_cast<float>(u), static_cast<float>(v)) /
               255.0f;
      },
      options);
}

}  // namespace facet
