// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "render/ray_scene.h"

#include <embree3/rtcore.h>
#include <glog/logging.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <limits>
#include <string>

#include "util/errors.h"
#include "util/parallel_for.h"

namespace facet {
namespace {

using Eigen::Vector3d;

constexpr float kFloatMax = 1e30f;

float ToFloat(double x) {
  return static_cast<float>(std::clamp(x, -1e30, 1e30));
}

// The point of triangle (a, b, c) closest to p as barycentrics (u, v), by the
// Voronoi regions of its vertices, edges and inside.
Eigen::Vector2d ClosestOnTriangle(const Vector3d& p,
                                  const Vector3d& a,
                                  const Vector3d& b,
                                  const Vector3d& c) {
  const Vector3d ab = b - a, ac = c - a, ap = p - a;
  const double d1 = ab.dot(ap), d2 = ac.dot(ap);
  if (d1 <= 0 && d2 <= 0) return {0, 0};
  const Vector3d bp = p - b;
  const double d3 = ab.dot(bp), d4 = ac.dot(bp);
  if (d3 >= 0 && d4 <= d3) return {1, 0};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0 && d1 > d3) return {d1 / (d1 - d3), 0};
  const Vector3d cp = p - c;
  const double d5 = ab.dot(cp), d6 = ac.dot(cp);
  if (d6 >= 0 && d5 <= d6) return {0, 1};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0 && d2 > d6) return {0, d2 / (d2 - d6)};
  const double va = d3 * d6 - d5 * d4;
  const double e = d4 - d3, f = d5 - d6;
  if (va <= 0 && e >= 0 && f >= 0 && e + f > 0) {
    const double w = e / (e + f);
    return {1 - w, w};
  }
  const double sum = va + vb + vc;
  if (!(sum > 0)) return {0, 0};  // a point-like triangle
  return {vb / sum, vc / sum};
}

void ReportDeviceError(void*, RTCError code, const char* text) {
  LOG(ERROR) << "Embree error " << static_cast<int>(code) << ": " << text;
}

}  // namespace

struct RayScene::Impl {
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;
  std::vector<Vector3d> vertices;
  std::vector<std::array<int, 3>> faces;

  ~Impl() {
    if (scene) rtcReleaseScene(scene);
    if (device) rtcReleaseDevice(device);
  }

  void AddTriangles() {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* xyz =
        static_cast<float*>(rtcSetNewGeometryBuffer(geometry,
                                                    RTC_BUFFER_TYPE_VERTEX,
                                                    0,
                                                    RTC_FORMAT_FLOAT3,
                                                    3 * sizeof(float),
                                                    vertices.size()));
    auto* ids =
        static_cast<unsigned*>(rtcSetNewGeometryBuffer(geometry,
                                                       RTC_BUFFER_TYPE_INDEX,
                                                       0,
                                                       RTC_FORMAT_UINT3,
                                                       3 * sizeof(unsigned),
                                                       faces.size()));
    CHECK(xyz && ids) << "Embree cannot allocate " << faces.size() << " faces";
    for (size_t i = 0; i < vertices.size(); ++i) {
      for (int k = 0; k < 3; ++k) xyz[3 * i + k] = ToFloat(vertices[i][k]);
    }
    for (size_t i = 0; i < faces.size(); ++i) {
      for (int k = 0; k < 3; ++k) ids[3 * i + k] = faces[i][k];
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
  }

  // Solves for t, u, v in double on the plane of the face Embree found.
  void Refine(const Vector3d& origin,
              const Vector3d& direction,
              RayHit* hit) const {
    const auto& f = faces[hit->face];
    const Vector3d e1 = vertices[f[1]] - vertices[f[0]];
    const Vector3d e2 = vertices[f[2]] - vertices[f[0]];
    const Vector3d p = direction.cross(e2);
    const double det = e1.dot(p);
    // Almost edge-on: float32 is as good as it gets.
    if (std::abs(det) < 1e-9 * e1.norm() * e2.norm() * direction.norm()) return;
    const Vector3d s = origin - vertices[f[0]];
    const Vector3d q = s.cross(e1);
    hit->t = e2.dot(q) / det;
    hit->u = std::clamp(s.dot(p) / det, 0.0, 1.0);
    hit->v = std::clamp(direction.dot(q) / det, 0.0, 1.0 - hit->u);
  }
};

RayScene::RayScene(const TriMesh& mesh) : impl_(new Impl) {
  impl_->vertices = mesh.vertices;
  impl_->faces = mesh.faces;
  impl_->device = rtcNewDevice(nullptr);
  CHECK(impl_->device) << "Embree does not start on this machine";
  rtcSetDeviceErrorFunction(impl_->device, ReportDeviceError, nullptr);
  impl_->scene = rtcNewScene(impl_->device);
  rtcSetSceneFlags(impl_->scene, RTC_SCENE_FLAG_ROBUST);
  if (!mesh.faces.empty()) impl_->AddTriangles();
  // The shape of the tree, and with it the winner among faces that meet in the
  // hit point, depends on how many threads build it: always one.
  tbb::task_arena(1).execute([this] { rtcCommitScene(impl_->scene); });
}

RayScene::~RayScene() = default;

const std::vector<Vector3d>& RayScene::vertices() const {
  return impl_->vertices;
}

const std::vector<std::array<int, 3>>& RayScene::faces() const {
  return impl_->faces;
}

RayHit RayScene::Intersect(const Vector3d& origin,
                           const Vector3d& direction,
                           double t_min,
                           double t_max) const {
  RTCRayHit query = {};
  query.ray.org_x = ToFloat(origin.x());
  query.ray.org_y = ToFloat(origin.y());
  query.ray.org_z = ToFloat(origin.z());
  query.ray.dir_x = ToFloat(direction.x());
  query.ray.dir_y = ToFloat(direction.y());
  query.ray.dir_z = ToFloat(direction.z());
  query.ray.tnear = ToFloat(t_min);
  query.ray.tfar = ToFloat(t_max);
  query.ray.mask = ~0u;
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(impl_->scene, &context, &query);
  RayHit hit;
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return hit;
  hit.face = static_cast<int>(query.hit.primID);
  hit.t = query.ray.tfar;
  hit.u = query.hit.u;
  hit.v = query.hit.v;
  impl_->Refine(origin, direction, &hit);
  return hit;
}

bool RayScene::Occluded(const Vector3d& origin,
                        const Vector3d& direction,
                        double t_min,
                        double t_max) const {
  RTCRay ray = {};
  ray.org_x = ToFloat(origin.x());
  ray.org_y = ToFloat(origin.y());
  ray.org_z = ToFloat(origin.z());
  ray.dir_x = ToFloat(direction.x());
  ray.dir_y = ToFloat(direction.y());
  ray.dir_z = ToFloat(direction.z());
  ray.tnear = ToFloat(t_min);
  ray.tfar = ToFloat(t_max);
  ray.mask = ~0u;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(impl_->scene, &context, &ray);
  return ray.tfar == -std::numeric_limits<float>::infinity();
}

namespace {

struct NearestQuery {
  Vector3d point;
  const std::vector<Vector3d>* vertices;
  const std::vector<std::array<int, 3>>* faces;
  double squared = 0;
  NearestHit best;
};

bool VisitTriangle(RTCPointQueryFunctionArguments* args) {
  auto* query = static_cast<NearestQuery*>(args->userPtr);
  const int face = static_cast<int>(args->primID);
  const auto& f = (*query->faces)[face];
  const Vector3d& a = (*query->vertices)[f[0]];
  const Vector3d& b = (*query->vertices)[f[1]];
  const Vector3d& c = (*query->vertices)[f[2]];
  const Eigen::Vector2d uv = ClosestOnTriangle(query->point, a, b, c);
  const Vector3d on_face = a + uv.x() * (b - a) + uv.y() * (c - a);
  const double squared = (on_face - query->point).squaredNorm();
  // Ties (edges, vertices) go to the lowest face.
  const bool tie = squared == query->squared && query->best.face >= 0;
  if (squared > query->squared || (tie && face > query->best.face)) {
    return false;
  }
  query->squared = squared;
  query->best.face = face;
  query->best.point = on_face;
  query->best.u = uv.x();
  query->best.v = uv.y();
  // A little larger than the truth, so that float rounding hides no triangle.
  const double radius = std::sqrt(squared) * (1 + 1e-6) + 1e-6;
  args->query->radius = std::min(args->query->radius, ToFloat(radius));
  return true;
}

}  // namespace

NearestHit RayScene::NearestPoint(const Vector3d& point,
                                  double max_distance) const {
  NearestQuery state;
  state.point = point;
  state.vertices = &impl_->vertices;
  state.faces = &impl_->faces;
  state.squared = max_distance * max_distance;
  RTCPointQuery query = {};
  query.x = ToFloat(point.x());
  query.y = ToFloat(point.y());
  query.z = ToFloat(point.z());
  query.radius = max_distance > 1e18
                     ? std::numeric_limits<float>::infinity()
                     : ToFloat(max_distance * (1 + 1e-6) + 1e-6);
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(impl_->scene, &query, &context, VisitTriangle, &state);
  if (state.best.face >= 0) state.best.distance = std::sqrt(state.squared);
  return state.best;
}

// One row of a camera in packets of eight neighbouring rays.
struct RayPackets {
  static constexpr int kLanes = 8;

  static void CastRow(const RayScene& scene,
                      const Pinhole& camera,
                      const Pose& world_from_cam,
                      int row,
                      DepthRender* render) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
    const Vector3d origin = world_from_cam.translation;
    const Eigen::Matrix3d rotation = world_from_cam.RotationMatrix();
    alignas(32) int valid[kLanes];
    RTCRayHit8 packet = {};
    for (int x0 = 0; x0 < camera.width; x0 += kLanes) {
      for (int k = 0; k < kLanes; ++k) {
        valid[k] = x0 + k < camera.width ? -1 : 0;
        const Vector3d d = rotation * camera.Unproject(x0 + k, row);
        packet.ray.org_x[k] = ToFloat(origin.x());
        packet.ray.org_y[k] = ToFloat(origin.y());
        packet.ray.org_z[k] = ToFloat(origin.z());
        packet.ray.dir_x[k] = ToFloat(d.x());
        packet.ray.dir_y[k] = ToFloat(d.y());
        packet.ray.dir_z[k] = ToFloat(d.z());
        packet.ray.tnear[k] = 0;
        packet.ray.tfar[k] = kFloatMax;
        packet.ray.time[k] = 0;
        packet.ray.mask[k] = ~0u;
        packet.ray.flags[k] = 0;
        packet.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
        packet.hit.instID[0][k] = RTC_INVALID_GEOMETRY_ID;
      }
      rtcIntersect8(valid, scene.impl_->scene, &context, &packet);
      const size_t pixel = static_cast<size_t>(row) * camera.width + x0;
      for (int k = 0; k < kLanes && x0 + k < camera.width; ++k) {
        if (packet.hit.geomID[k] == RTC_INVALID_GEOMETRY_ID) continue;
        render->depth[pixel + k] = packet.ray.tfar[k];
        render->face[pixel + k] = static_cast<int>(packet.hit.primID[k]);
        render->u[pixel + k] = packet.hit.u[k];
        render->v[pixel + k] = packet.hit.v[k];
      }
    }
  }
};

DepthRender RenderDepth(const RayScene& scene,
                        const Pinhole& camera,
                        const Pose& cam_from_world) {
  DepthRender render;
  render.width = camera.width;
  render.height = camera.height;
  const size_t size = static_cast<size_t>(camera.width) * camera.height;
  render.depth.assign(size, 0);
  render.face.assign(size, -1);
  render.u.assign(size, 0);
  render.v.assign(size, 0);
  const Pose world_from_cam = cam_from_world.Inverse();
  ParallelFor(
      0,
      camera.height,
      [&](size_t row) {
        RayPackets::CastRow(
            scene, camera, world_from_cam, static_cast<int>(row), &render);
      },
      8);
  return render;
}

}  // namespace facet
