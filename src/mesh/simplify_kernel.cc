// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Building the kernel, mending what collapses cannot, and reading it out.
#include "mesh/simplify_kernel.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "util/errors.h"

namespace facet {

Collapser::Impl::Impl(const TriMesh& mesh,
                      const PlanarPartition& partition_in,
                      const SimplifyOptions& options_in,
                      int faces_per_region)
    : partition(partition_in),
      options(options_in),
      soft_limits(ShapeLimits::Soft(options_in)),
      hard_limits(ShapeLimits::Hard(options_in)) {
  const MeshRegions regions =
      DivideIntoRegions(mesh, partition.face_cluster, faces_per_region);
  BuildKernel(mesh, regions);
  MarkBorders();
  BuildQuadrics(mesh, regions);
}

// Numbers faces and edges region by region, vertices as the faces come across
// them: what is near lies together in memory.
void Collapser::Impl::BuildKernel(const TriMesh& mesh,
                                  const MeshRegions& regions) {
  for (const auto& v : mesh.vertices) center += v;
  center /= static_cast<double>(std::max<size_t>(1, mesh.NumVertices()));
  kernel.reserve(
      mesh.NumVertices(), 3 * mesh.NumFaces() / 2 + 1000, mesh.NumFaces());
  vertices.reserve(mesh.NumVertices());
  birth.reserve(mesh.NumVertices());
  label.reserve(mesh.NumFaces());
  std::vector<int> number(mesh.NumVertices(), -1);
  for (int r = 0; r < regions.Count(); ++r) {
    first_edge.push_back(static_cast<int>(kernel.n_edges()));
    for (int i = regions.begin[r]; i < regions.begin[r + 1]; ++i) {
      const int f = regions.faces[i];
      VertexHandle corner[3];
      for (int k = 0; k < 3; ++k) {
        const int v = mesh.faces[f][k];
        if (number[v] < 0) {
          number[v] = kernel.new_vertex().idx();
          birth.push_back(v);
          vertices.emplace_back();
          vertices.back().position = mesh.vertices[v] - center;
        }
        corner[k] = VertexHandle(number[v]);
      }
      if (!kernel.add_face(corner[0], corner[1], corner[2]).is_valid()) {
        throw UnsolvableError(
            "simplification: the mesh is not manifold at face " +
            std::to_string(f) +
            "; split non-manifold edges and vertices first");
      }
      label.push_back(partition.face_cluster[f]);
    }
  }
  first_edge.push_back(static_cast<int>(kernel.n_edges()));
  first_face = regions.begin;
  for (size_t f = 0; f < mesh.NumFaces(); ++f) total_area += mesh.FaceArea(f);
  counts.faces = static_cast<int>(mesh.NumFaces());
  cluster_faces.assign(partition.clusters.size(), 0);
  for (const int id : label) ++cluster_faces[id];
}

void Collapser::Impl::MarkBorders() {
  border.assign(kernel.n_edges(), 0);
  rejected.assign(kernel.n_edges(), 0);
  refused.assign(kernel.n_vertices(), 0);
  attempt.assign(kernel.n_edges(), 0);
  for (const EdgeHandle e : kernel.edges()) {
    const HalfedgeHandle h = kernel.halfedge_handle(e, 0);
    const auto left = kernel.face_handle(h);
    const auto right = kernel.opposite_face_handle(h);
    if (left.is_valid() && right.is_valid() &&
        label[left.idx()] == label[right.idx()]) {
      continue;
    }
    border[e.idx()] = 1;
    ++counts.border;
    ++vertices[kernel.from_vertex_handle(h).idx()].border_degree;
    ++vertices[kernel.to_vertex_handle(h).idx()].border_degree;
  }
  if (options.stop != SimplifyStop::kCounts) return;
  cluster_inner.assign(partition.clusters.size(), 0);
  for (const EdgeHandle e : kernel.edges()) {
    if (ClassOf(e) == kInner) ++cluster_inner[ClusterOf(e)];
  }
}

void Collapser::Impl::BuildQuadrics(const TriMesh& mesh,
                                    const MeshRegions& regions) {
  const double point_weight =
      options.point_share * total_area / std::max(1, counts.faces);
  const double reach = options.plane_reach_m;
  quadric.reserve(vertices.size());
  for (const VertexData& v : vertices) {
    quadric.push_back(Quadric::Point(v.position, point_weight));
  }
  for (int f = 0; f < counts.faces; ++f) {
    const Eigen::Vector3d cross = mesh.FaceCross(regions.faces[f]);
    const double norm = cross.norm();
    if (!(norm > 0)) continue;
    const Eigen::Vector3d n = cross / norm;
    const double w = norm / 6;  // a third of the area, per corner
    const Plane& plane = partition.clusters[label[f]].plane;
    const double off =
        reach > 0
            ? plane.SignedDistance(mesh.FaceCentroid(regions.faces[f])) / reach
            : 0.0;
    const double share = options.cluster_plane_share / (1 + off * off);
    const OpenMesh::FaceHandle face(f);
    const VertexHandle first = *kernel.cfv_begin(face);
    Quadric q = Quadric::Plane(
        n, -n.dot(vertices[first.idx()].position), (1 - share) * w);
    q += Quadric::Plane(plane.normal, plane.SignedDistance(center), share * w);
    for (const VertexHandle v : kernel.fv_range(face)) {
      quadric[v.idx()] += q;
      vertices[v.idx()].weight += w;
      vertices[v.idx()].facing += w * n;
    }
  }
  for (const EdgeHandle e : kernel.edges()) {
    if (!border[e.idx()]) continue;
    const HalfedgeHandle h = kernel.halfedge_handle(e, 0);
    const int a = kernel.from_vertex_handle(h).idx();
    const int b = kernel.to_vertex_handle(h).idx();
    const Eigen::Vector3d d = vertices[b].position - vertices[a].position;
    const double length_sq = d.squaredNorm();
    if (!(length_sq > 0)) continue;
    const Quadric q = Quadric::Line(
        vertices[a].position,
        d / std::sqrt(length_sq),
        length_sq * (kernel.is_boundary(e) ? options.mesh_boundary_weight
                                           : options.cluster_border_weight));
    quadric[a] += q;
    quadric[b] += q;
  }
}

double Collapser::Impl::AreaOf(OpenMesh::FaceHandle face) const {
  const HalfedgeHandle h = kernel.halfedge_handle(face);
  const Eigen::Vector3d& p =
      vertices[kernel.from_vertex_handle(h).idx()].position;
  const Eigen::Vector3d& q =
      vertices[kernel.to_vertex_handle(h).idx()].position;
  const Eigen::Vector3d& r =
      vertices[kernel.to_vertex_handle(kernel.next_halfedge_handle(h)).idx()]
          .position;
  return 0.5 * (q - p).cross(r - p).norm();
}

// Removes a face by the first admissible collapse of one of its sides.
bool Collapser::Impl::CollapseSideOf(OpenMesh::FaceHandle face) {
  for (const EdgeHandle e : kernel.fe_range(face)) {
    if (!MayCollapse(e)) continue;
    for (int target = 0; target < kNumTargets; ++target) {
      const Collapse plan = Plan(e, target);
      if (ErrorOf(plan) <= options.max_error_m && LinkAllows(plan) &&
          ShapeAllows(plan, soft_limits)) {
        Execute(plan, &counts);
        return true;
      }
      if (plan.fixed_target) break;
    }
  }
  return false;
}

// Flips the side of the face that lies opposite to its widest corner, if both
// new faces have an area and look to the side of the old neighbour.
bool Collapser::Impl::FlipSideOf(OpenMesh::FaceHandle face) {
  for (const HalfedgeHandle h : kernel.fh_range(face)) {
    const EdgeHandle e = kernel.edge_handle(h);
    if (border[e.idx()] || !kernel.is_flip_ok(e)) continue;
    const HalfedgeHandle o = kernel.opposite_halfedge_handle(h);
    const auto at = [this](VertexHandle v) {
      return vertices[v.idx()].position;
    };
    const Eigen::Vector3d a = at(kernel.from_vertex_handle(h));
    const Eigen::Vector3d b = at(kernel.to_vertex_handle(h));
    const Eigen::Vector3d c =
        at(kernel.to_vertex_handle(kernel.next_halfedge_handle(h)));
    const Eigen::Vector3d d =
        at(kernel.to_vertex_handle(kernel.next_halfedge_handle(o)));
    const Eigen::Vector3d old_cross = (a - b).cross(d - b);
    const Eigen::Vector3d cross_a = (d - a).cross(c - a);
    const Eigen::Vector3d cross_b = (c - b).cross(d - b);
    if (std::min(cross_a.norm(), cross_b.norm()) < 2 * kNoNormal ||
        cross_a.dot(old_cross) <= 0 || cross_b.dot(old_cross) <= 0) {
      continue;
    }
    kernel.flip(e);
    return true;
  }
  return false;
}

bool Collapser::Impl::MayMove(VertexHandle v,
                              const Eigen::Vector3d& target) const {
  for (const HalfedgeHandle h : kernel.voh_range(v)) {
    if (kernel.is_boundary(h)) continue;
    const VertexHandle v2 = kernel.to_vertex_handle(h);
    const VertexHandle v3 =
        kernel.to_vertex_handle(kernel.next_halfedge_handle(h));
    if (!MayMoveCorner(vertices[v.idx()].position,
                       target,
                       vertices[v2.idx()].position,
                       vertices[v3.idx()].position,
                       vertices[v.idx()].facing + vertices[v2.idx()].facing +
                           vertices[v3.idx()].facing,
                       soft_limits)) {
      return false;
    }
  }
  return true;
}

// Gives a face an area by moving one corner inside its plane, 10 um to 1 mm:
// the last resort for specks of a micrometre among needles.
bool Collapser::Impl::NudgeCornerOf(OpenMesh::FaceHandle face) {
  const Eigen::Vector3d n = partition.clusters[label[face.idx()]].plane.normal;
  const Eigen::Vector3d u = n.unitOrthogonal();
  const Eigen::Vector3d w = n.cross(u);
  for (double step = 1e-5; step < 2e-3; step *= 10) {
    for (const VertexHandle v : kernel.fv_range(face)) {
      if (options.keep_mesh_boundary && kernel.is_boundary(v)) continue;
      const Eigen::Vector3d old = vertices[v.idx()].position;
      for (int k = 0; k < 16; ++k) {
        const double angle = M_PI / 8 * k;
        const Eigen::Vector3d target =
            old + step * (std::cos(angle) * u + std::sin(angle) * w);
        if (!MayMove(v, target)) continue;
        vertices[v.idx()].position = target;
        if (AreaOf(face) >= kNoNormal) return true;
        vertices[v.idx()].position = old;
      }
    }
  }
  return false;
}

// The dense mesh may bring faces without area along that no cheap collapse came
// across.
void Collapser::Impl::RemoveFlatFaces() {
  active = kInner | kBorder;
  for (const auto face : kernel.faces()) {
    if (kernel.status(face).deleted() || AreaOf(face) >= kNoNormal) continue;
    if (!CollapseSideOf(face) && !FlipSideOf(face)) NudgeCornerOf(face);
  }
}

void Collapser::Extract(SimplifyResult* result) const {
  const Impl& m = *impl_;
  std::vector<int> index(m.vertices.size(), -1);
  for (const auto f : m.kernel.faces()) {
    std::array<int, 3> face;
    int k = 0;
    for (const VertexHandle v : m.kernel.fv_range(f)) {
      int& i = index[v.idx()];
      if (i < 0) {
        i = static_cast<int>(result->vertex_birth.size());
        result->vertex_birth.push_back(m.birth[v.idx()]);
        result->mesh.vertices.push_back(m.vertices[v.idx()].position +
                                        m.center);
      }
      face[k++] = i;
    }
    result->mesh.faces.push_back(face);
    result->partition.face_cluster.push_back(m.label[f.idx()]);
  }
  result->report.collapses = m.counts.collapses;
  result->report.max_error_m = m.counts.max_error;
}

}  // namespace facet
