// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "render/picture.h"

#include <algorithm>
#include <cmath>

#include "mesh/mesh_io.h"
#include "util/parallel_for.h"

namespace facet {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

// How many culled faces a ray may pass before it counts as background.
constexpr int kMaxCulled = 64;

// Of the finer raster of samples.
Pinhole SampleCamera(const PreviewView& view, int supersampling) {
  Pinhole camera = view.camera;
  camera.fx *= supersampling;
  camera.fy *= supersampling;
  camera.cx = (camera.cx + 0.5) * supersampling - 0.5;
  camera.cy = (camera.cy + 0.5) * supersampling - 0.5;
  camera.width *= supersampling;
  camera.height *= supersampling;
  return camera;
}

// The first face behind `t` that is not seen from behind.
RayHit FirstFrontHit(const RayScene& scene,
                     const TriMesh& mesh,
                     const Vector3d& origin,
                     const Vector3d& direction,
                     double t) {
  for (int i = 0; i < kMaxCulled; ++i) {
    const RayHit hit =
        scene.Intersect(origin, direction, t * (1 + 1e-6) + 1e-6);
    if (hit.face < 0 || mesh.FaceCross(hit.face).dot(direction) < 0) return hit;
    t = hit.t;
  }
  return RayHit();
}

// What one sample needs of the mesh, beside its colour.
class SampleShader {
 public:
  SampleShader(const SampledView& sampled,
               const TriMesh& mesh,
               const DrawOptions& options)
      : mesh_(mesh), options_(options) {
    const Pose world_from_cam = sampled.view.cam_from_world.Inverse();
    const double focal =
        0.5 * (sampled.view.camera.fx + sampled.view.camera.fy);
    // Over the left shoulder of the camera: reveals relief that a lamp in the
    // camera itself would flatten.
    key_light_ =
        (world_from_cam.rotation * Vector3d(-0.5, -0.6, -0.62).normalized())
            .cast<float>();
    if (options.shade && options.smooth_normals) SumNormals();
    if (options.shade && !options.smooth_normals) FindFaceNormals();
    if (options.wireframe_px > 0) {
      FindEdges(world_from_cam.translation, focal);
    }
  }

  // Light on the surface, in [0, 1].
  float Light(int face, float u, float v, const Vector3f& ray) const {
    Vector3f normal =
        face_normals_.empty() ? SmoothNormal(face, u, v) : face_normals_[face];
    if (normal.dot(ray) > 0) normal = -normal;
    const float head = std::max(0.0f, -normal.dot(ray));
    const float key = std::max(0.0f, normal.dot(key_light_));
    return 0.26f + 0.46f * head + 0.34f * key;
  }

  // 1 on an edge of the face, 0 from half a line width (+ 1/2 px) on.
  float Edge(int face, const Vector3f& ray) const {
    const Eigen::Matrix3f& edges = edges_[face];
    const float nearest = (edges * ray).cwiseAbs().minCoeff();
    const float px = nearest - 0.5f * static_cast<float>(options_.wireframe_px);
    return std::clamp(0.5f - px, 0.0f, 1.0f);
  }

 private:
  void SumNormals() {
    vertex_normals_.assign(mesh_.NumVertices(), Vector3f::Zero());
    for (size_t f = 0; f < mesh_.NumFaces(); ++f) {
      const Vector3f n = mesh_.FaceCross(f).cast<float>();
      for (int i : mesh_.faces[f]) vertex_normals_[i] += n;
    }
    for (auto& n : vertex_normals_) n.normalize();
  }

  void FindFaceNormals() {
    face_normals_.resize(mesh_.NumFaces());
    for (size_t f = 0; f < mesh_.NumFaces(); ++f) {
      face_normals_[f] = mesh_.FaceCross(f).normalized().cast<float>();
    }
  }

  // Rows: the normals of the planes through the camera and an edge, times the
  // focal length.
  void FindEdges(const Vector3d& center, double focal) {
    edges_.resize(mesh_.NumFaces());
    for (size_t f = 0; f < mesh_.NumFaces(); ++f) {
      for (int k = 0; k < 3; ++k) {
        const Vector3d a = mesh_.vertices[mesh_.faces[f][k]] - center;
        const Vector3d b = mesh_.vertices[mesh_.faces[f][(k + 1) % 3]] - center;
        Vector3d m = a.cross(b);
        const double norm = m.norm();
        // An edge that points at the camera is a point: no line.
        m = norm > 0 ? Vector3d(m * (focal / norm)) : Vector3d::Constant(1e30);
        edges_[f].row(k) = m.cast<float>();
      }
    }
  }

  Vector3f SmoothNormal(int face, float u, float v) const {
    const auto& f = mesh_.faces[face];
    return ((1 - u - v) * vertex_normals_[f[0]] + u * vertex_normals_[f[1]] +
            v * vertex_normals_[f[2]])
        .normalized();
  }

  const TriMesh& mesh_;
  const DrawOptions& options_;
  Vector3f key_light_;
  std::vector<Vector3f> vertex_normals_, face_normals_;
  std::vector<Eigen::Matrix3f> edges_;
};

uint8_t ToByte(float x) {
  return static_cast<uint8_t>(std::clamp(x, 0.0f, 1.0f) * 255.0f + 0.5f);
}

}  // namespace

SampledView SampleView(const RayScene& scene,
                       const TriMesh& mesh,
                       const PreviewView& view,
                       int supersampling) {
  const Pinhole camera = SampleCamera(view, supersampling);
  DepthRender first = RenderDepth(scene, camera, view.cam_from_world);
  if (view.cull_back_faces) {
    const Pose world_from_cam = view.cam_from_world.Inverse();
    const Eigen::Matrix3d rotation = world_from_cam.RotationMatrix();
    ParallelFor(0, camera.height, [&](size_t y) {
      for (int x = 0; x < camera.width; ++x) {
        const size_t i = y * camera.width + x;
        if (first.face[i] < 0) continue;
        const Vector3d direction =
            rotation * camera.Unproject(x, static_cast<double>(y));
        if (mesh.FaceCross(first.face[i]).dot(direction) < 0) continue;
        const RayHit hit = FirstFrontHit(
            scene, mesh, world_from_cam.translation, direction, first.depth[i]);
        first.face[i] = hit.face;
        first.u[i] = static_cast<float>(hit.u);
        first.v[i] = static_cast<float>(hit.v);
      }
    });
  }
  SampledView sampled;
  sampled.view = view;
  sampled.supersampling = supersampling;
  sampled.face = std::move(first.face);
  sampled.u = std::move(first.u);
  sampled.v = std::move(first.v);
  return sampled;
}

SurfaceColor UniformColor(const Vector3f& rgb) {
  return [rgb](int, double, double) { return rgb; };
}

SurfaceColor PlaneColors(const std::vector<int>& face_plane) {
  std::vector<Vector3f> colors;  // by plane
  for (const int plane : face_plane) {
    while (static_cast<int>(colors.size()) <= plane) {
      const Rgb rgb = PlaneColor(static_cast<int>(colors.size()));
      colors.push_back(Vector3f(rgb[0], rgb[1], rgb[2]) / 255.0f);
    }
  }
  return [face_plane, colors = std::move(colors)](int face, double, double) {
    const int plane = face_plane[face];
    return plane < 0 ? Vector3f(Vector3f::Constant(0.7f)) : colors[plane];
  };
}

SurfaceColor VertexColors(const TriMesh& mesh) {
  return [&mesh](int face, double u, double v) -> Vector3f {
    const double weights[3] = {1 - u - v, u, v};
    Vector3f sum = Vector3f::Zero();
    for (int k = 0; k < 3; ++k) {
      const Rgb& c = mesh.vertex_colors[mesh.faces[face][k]];
      sum +=
          static_cast<float>(weights[k] / 255.0) * Vector3f(c[0], c[1], c[2]);
    }
    return sum;
  };
}

Picture DrawView(const SampledView& sampled,
                 const TriMesh& mesh,
                 const SurfaceColor& color,
                 const DrawOptions& options) {
  const SampleShader shader(sampled, mesh, options);
  const bool needs_ray = options.shade || options.wireframe_px > 0;
  const Eigen::Matrix3d world_from_cam =
      sampled.view.cam_from_world.Inverse().RotationMatrix();
  const int s = sampled.supersampling;
  const Pinhole camera = SampleCamera(sampled.view, s);
  Picture picture;
  picture.width = sampled.view.camera.width;
  picture.height = sampled.view.camera.height;
  picture.rgb.resize(3 * static_cast<size_t>(picture.width) * picture.height);

  const auto sample_color = [&](int x, int y) -> Vector3f {
    const size_t i = static_cast<size_t>(y) * camera.width + x;
    const int face = sampled.face[i];
    if (face < 0) {
      const float down = (y + 0.5f) / camera.height;
      return (1 - down) * options.background_top +
             down * options.background_bottom;
    }
    const float u = sampled.u[i], v = sampled.v[i];
    Vector3f rgb = color(face, u, v);
    if (!needs_ray) return rgb;
    const Vector3f ray =
        (world_from_cam * camera.Unproject(x, y)).cast<float>().normalized();
    if (options.shade) rgb *= shader.Light(face, u, v, ray);
    if (options.wireframe_px > 0) {
      const float edge = shader.Edge(face, ray);
      rgb = (1 - edge) * rgb + edge * options.wireframe_rgb;
    }
    return rgb;
  };
  ParallelFor(
      0,
      picture.height,
      [&](size_t y) {
        for (int x = 0; x < picture.width; ++x) {
          Vector3f sum = Vector3f::Zero();
          for (int k = 0; k < s * s; ++k) {
            sum += sample_color(x * s + k % s, static_cast<int>(y) * s + k / s);
          }
          uint8_t* out = &picture.rgb[3 * (y * picture.width + x)];
          for (int c = 0; c < 3; ++c) out[c] = ToByte(sum[c] / (s * s));
        }
      },
      4);
  return picture;
}

}  // namespace facet
