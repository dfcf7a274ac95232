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

Vector3d RayDirection(const SampledView& sampled, int x, int y) {
  const double s = 1.0 / sampled.supersampling;
  return sampled.view.camera.Unproject((x + 0.5) * s - 0.5,
                                       (y + 0.5) * s - 0.5);
}

RayHit FirstHit(const RayScene& scene,
                const TriMesh& mesh,
                const Vector3d& origin,
                const Vector3d& direction,
                bool cull_back_faces) {
  double t_min = 0;
  for (int i = 0; i < kMaxCulled; ++i) {
    const RayHit hit = scene.Intersect(origin, direction, t_min);
    if (hit.face < 0 || !cull_back_faces ||
        mesh.FaceCross(hit.face).dot(direction) < 0) {
      return hit;
    }
    t_min = hit.t * (1 + 1e-6) + 1e-6;
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
    center_ = world_from_cam.translation;
    focal_ = 0.5 * (sampled.view.camera.fx + sampled.view.camera.fy);
    // Over the left shoulder of the camera: reveals relief that a lamp in the
    // camera itself would flatten.
    key_light_ =
        world_from_cam.rotation * Vector3d(-0.5, -0.6, -0.62).normalized();
    if (options.shade && options.smooth_normals) SumNormals();
  }

  // Light on the surface, in [0, 1].
  float Light(int face, double u, double v, const Vector3d& ray) const {
    Vector3d normal = Normal(face, u, v);
    if (normal.dot(ray) > 0) normal = -normal;
    const double head = std::max(0.0, -normal.dot(ray));
    const double key = std::max(0.0, normal.dot(key_light_));
    return static_cast<float>(0.26 + 0.46 * head + 0.34 * key);
  }

  // 1 on an edge of the face, 0 from half a line width (+ 1/2 px) on.
  float Edge(int face, const Vector3d& ray) const {
    double nearest = 1e30;
    for (int k = 0; k < 3; ++k) {
      const Vector3d a = Vertex(face, k) - center_;
      const Vector3d b = Vertex(face, (k + 1) % 3) - center_;
      const Vector3d m = a.cross(b);
      const double norm = m.norm();
      if (norm > 0) nearest = std::min(nearest, std::abs(m.dot(ray)) / norm);
    }
    const double px = nearest * focal_ - 0.5 * options_.wireframe_px;
    return static_cast<float>(std::clamp(0.5 - px, 0.0, 1.0));
  }

 private:
  const Vector3d& Vertex(int face, int k) const {
    return mesh_.vertices[mesh_.faces[face][k]];
  }

  void SumNormals() {
    vertex_normals_.assign(mesh_.NumVertices(), Vector3f::Zero());
    for (size_t f = 0; f < mesh_.NumFaces(); ++f) {
      const Vector3f n = mesh_.FaceCross(f).cast<float>();
      for (int i : mesh_.faces[f]) vertex_normals_[i] += n;
    }
    for (auto& n : vertex_normals_) n.normalize();
  }

  Vector3d Normal(int face, double u, double v) const {
    if (vertex_normals_.empty()) return mesh_.FaceCross(face).normalized();
    const auto& f = mesh_.faces[face];
    const Vector3f n = static_cast<float>(1 - u - v) * vertex_normals_[f[0]] +
                       static_cast<float>(u) * vertex_normals_[f[1]] +
                       static_cast<float>(v) * vertex_normals_[f[2]];
    return n.cast<double>().normalized();
  }

  const TriMesh& mesh_;
  const DrawOptions& options_;
  Vector3d center_, key_light_;
  double focal_ = 0;
  std::vector<Vector3f> vertex_normals_;
};

uint8_t ToByte(float x) {
  return static_cast<uint8_t>(std::clamp(x, 0.0f, 1.0f) * 255.0f + 0.5f);
}

}  // namespace

SampledView SampleView(const RayScene& scene,
                       const TriMesh& mesh,
                       const PreviewView& view,
                       int supersampling) {
  SampledView sampled;
  sampled.view = view;
  sampled.supersampling = supersampling;
  const int width = view.camera.width * supersampling;
  const int height = view.camera.height * supersampling;
  const size_t size = static_cast<size_t>(width) * height;
  sampled.face.assign(size, -1);
  sampled.u.assign(size, 0);
  sampled.v.assign(size, 0);
  const Pose world_from_cam = view.cam_from_world.Inverse();
  const Eigen::Matrix3d rotation = world_from_cam.RotationMatrix();
  ParallelFor(
      0,
      height,
      [&](size_t y) {
        for (int x = 0; x < width; ++x) {
          const Vector3d direction =
              rotation * RayDirection(sampled, x, static_cast<int>(y));
          const RayHit hit = FirstHit(scene,
                                      mesh,
                                      world_from_cam.translation,
                                      direction,
                                      view.cull_back_faces);
          const size_t i = y * width + x;
          sampled.face[i] = hit.face;
          sampled.u[i] = static_cast<float>(hit.u);
          sampled.v[i] = static_cast<float>(hit.v);
        }
      },
      4);
  return sampled;
}

SurfaceColor UniformColor(const Vector3f& rgb) {
  return [rgb](int, double, double) { return rgb; };
}

SurfaceColor PlaneColors(const std::vector<int>& face_plane) {
  return [face_plane](int face, double, double) -> Vector3f {
    if (face_plane[face] < 0) return Vector3f::Constant(0.7f);
    const Rgb rgb = PlaneColor(face_plane[face]);
    return Vector3f(rgb[0], rgb[1], rgb[2]) / 255.0f;
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
  const Eigen::Matrix3d world_from_cam =
      sampled.view.cam_from_world.Inverse().RotationMatrix();
  const int s = sampled.supersampling;
  Picture picture;
  picture.width = sampled.view.camera.width;
  picture.height = sampled.view.camera.height;
  picture.rgb.resize(3 * static_cast<size_t>(picture.width) * picture.height);

  const auto sample_color = [&](int x, int y) -> Vector3f {
    const size_t i = static_cast<size_t>(y) * picture.width * s + x;
    const int face = sampled.face[i];
    if (face < 0) {
      const float down = (y + 0.5f) / (picture.height * s);
      return (1 - down) * options.background_top +
             down * options.background_bottom;
    }
    const Vector3d ray =
        (world_from_cam * RayDirection(sampled, x, y)).normalized();
    const double u = sampled.u[i], v = sampled.v[i];
    Vector3f rgb = color(face, u, v);
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
