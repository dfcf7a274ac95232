// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Which collapses are admissible and what they do.
#include <algorithm>
#include <cmath>

#include "mesh/simplify_kernel.h"

namespace facet {

EdgeClass Collapser::Impl::ClassOf(EdgeHandle e) const {
  if (border[e.idx()]) return kBorder;
  const HalfedgeHandle h = kernel.halfedge_handle(e, 0);
  const int ends =
      (vertices[kernel.from_vertex_handle(h).idx()].border_degree > 0) +
      (vertices[kernel.to_vertex_handle(h).idx()].border_degree > 0);
  if (ends == 2 || (ends == 1 && !options.collapse_to_border)) return kChord;
  return kInner;
}

bool Collapser::Impl::MayCollapse(EdgeHandle e) const {
  const EdgeClass edge_class = ClassOf(e);
  if (!(edge_class & active)) return false;
  if (edge_class != kBorder) return true;
  const HalfedgeHandle h = kernel.halfedge_handle(e, 0);
  return !options.keep_mesh_boundary ||
         !kernel.is_boundary(kernel.from_vertex_handle(h)) ||
         !kernel.is_boundary(kernel.to_vertex_handle(h));
}

// Target 0 is the best; where its shape is refused, 1 to 3 are the midpoint and
// the two ends. With an end that has to stay there is only 0.
Collapse Collapser::Impl::Plan(EdgeHandle e, int target) const {
  Collapse plan;
  plan.halfedge = kernel.halfedge_handle(e, 0);
  int from = kernel.from_vertex_handle(plan.halfedge).idx();
  int to = kernel.to_vertex_handle(plan.halfedge).idx();
  // The end that has to stay put: the border end of an inner edge, or an end on
  // a boundary that is left alone. The vertex of a corner outlives others.
  const auto fixed = [&](int v) {
    return border[e.idx()] ? options.keep_mesh_boundary &&
                                 kernel.is_boundary(VertexHandle(v))
                           : vertices[v].border_degree > 0;
  };
  if (fixed(from) || (!fixed(to) && vertices[from].border_degree >
                                        vertices[to].border_degree)) {
    std::swap(from, to);
    plan.halfedge = kernel.opposite_halfedge_handle(plan.halfedge);
  }
  plan.fixed_target = fixed(to);
  const Quadric q = quadric[from] + quadric[to];
  const Eigen::Vector3d& a = vertices[from].position;
  const Eigen::Vector3d& b = vertices[to].position;
  plan.target = b;
  if (!plan.fixed_target) {
    Eigen::Vector3d best;
    if (target == 3) {
      plan.target = a;
    } else if (target <= 1) {
      plan.target = 0.5 * (a + b);
      if (target == 0 && q.Minimum(&best) &&
          (best - plan.target).squaredNorm() <= 4 * (a - b).squaredNorm()) {
        plan.target = best;
      }
    }
  }
  plan.cost = q(plan.target);
  return plan;
}

// Link condition on the labels and on the mesh: the cheaper one first.
bool Collapser::Impl::LinkAllows(const Collapse& collapse) const {
  const HalfedgeHandle h = collapse.halfedge;
  int lost_cluster = -1;
  for (const HalfedgeHandle side : {h, kernel.opposite_halfedge_handle(h)}) {
    if (kernel.is_boundary(side)) continue;
    const int id = label[kernel.face_handle(side).idx()];
    if (cluster_faces[id] <= 1 + (id == lost_cluster)) return false;
    lost_cluster = id;
    // A face whose other sides are both border joins two chains if it goes.
    const EdgeHandle next =
        kernel.edge_handle(kernel.next_halfedge_handle(side));
    const EdgeHandle prev =
        kernel.edge_handle(kernel.prev_halfedge_handle(side));
    if (border[next.idx()] && border[prev.idx()]) return false;
  }
  return RingsAllow(h);
}

// The link condition: what the rings of the two vertices have in common is
// opposite to the edge. The rules are those of OpenMesh's is_collapse_ok, which
// goes through three rings and marks their vertices.
bool Collapser::Impl::RingsAllow(HalfedgeHandle h) const {
  const VertexHandle ends[2] = {kernel.from_vertex_handle(h),
                                kernel.to_vertex_handle(h)};
  VertexHandle opposite[2];
  for (int k = 0; k < 2; ++k) {
    const HalfedgeHandle side = k == 0 ? h : kernel.opposite_halfedge_handle(h);
    if (kernel.is_boundary(side)) continue;
    const HalfedgeHandle next = kernel.next_halfedge_handle(side);
    const HalfedgeHandle last = kernel.next_halfedge_handle(next);
    // The face has no other neighbour: it would become an edge.
    if (kernel.is_boundary(kernel.opposite_halfedge_handle(next)) &&
        kernel.is_boundary(kernel.opposite_halfedge_handle(last))) {
      return false;
    }
    opposite[k] = kernel.to_vertex_handle(next);
  }
  if (opposite[0] == opposite[1]) return false;
  if (opposite[0].is_valid() && opposite[1].is_valid() &&
      kernel.is_boundary(ends[0]) && kernel.is_boundary(ends[1])) {
    return false;  // would join two boundaries
  }
  constexpr int kMost = 64;  // a fan of more is no shape to go on with
  int ring[kMost], size = 0, other_size = 0;
  for (const VertexHandle v : kernel.vv_range(ends[0])) {
    if (size == kMost) return false;
    ring[size++] = v.idx();
  }
  for (const VertexHandle v : kernel.vv_range(ends[1])) {
    ++other_size;
    if (v == opposite[0] || v == opposite[1]) continue;
    if (std::find(ring, ring + size, v.idx()) != ring + size) return false;
  }
  // A closed tetrahedron passes the test of the rings.
  return size != 3 || other_size != 3;
}

bool Collapser::Impl::ShapeAllows(const Collapse& collapse,
                                  const ShapeLimits& limits) const {
  const VertexHandle from = kernel.from_vertex_handle(collapse.halfedge);
  const VertexHandle to = kernel.to_vertex_handle(collapse.halfedge);
  const Eigen::Vector3d kept =
      vertices[from.idx()].facing + vertices[to.idx()].facing;
  for (const VertexHandle moved : {from, to}) {
    const VertexHandle other = moved == from ? to : from;
    if (moved == to && collapse.target == vertices[to.idx()].position) continue;
    for (auto it = kernel.cvoh_iter(moved); it.is_valid(); ++it) {
      if (kernel.is_boundary(*it)) continue;
      const VertexHandle v2 = kernel.to_vertex_handle(*it);
      const VertexHandle v3 =
          kernel.to_vertex_handle(kernel.next_halfedge_handle(*it));
      if (v2 == other || v3 == other) continue;
      if (!MayMoveCorner(
              vertices[moved.idx()].position,
              collapse.target,
              vertices[v2.idx()].position,
              vertices[v3.idx()].position,
              kept + vertices[v2.idx()].facing + vertices[v3.idx()].facing,
              limits)) {
        return false;
      }
    }
  }
  return true;
}

double Collapser::Impl::ErrorOf(const Collapse& collapse) const {
  const int from = kernel.from_vertex_handle(collapse.halfedge).idx();
  const int to = kernel.to_vertex_handle(collapse.halfedge).idx();
  return std::sqrt(collapse.cost /
                   (vertices[from].weight + vertices[to].weight));
}

// Adds `sign` to the counts of edges for those at both ends of h.
void Collapser::Impl::CountRing(HalfedgeHandle h, int sign, Counts* sum) {
  const VertexHandle from = kernel.from_vertex_handle(h);
  const VertexHandle to = kernel.to_vertex_handle(h);
  for (const VertexHandle v : {from, to}) {
    for (const EdgeHandle e : kernel.ve_range(v)) {
      if (v == to && e == kernel.edge_handle(h)) continue;
      const EdgeClass edge_class = ClassOf(e);
      if (edge_class == kBorder) sum->border += sign;
      if (edge_class == kInner) cluster_inner[ClusterOf(e)] += sign;
    }
  }
}

void Collapser::Impl::Execute(const Collapse& collapse, Counts* sum) {
  const HalfedgeHandle h = collapse.halfedge;
  const VertexHandle from = kernel.from_vertex_handle(h);
  const VertexHandle to = kernel.to_vertex_handle(h);
  sum->max_error = std::max(sum->max_error, ErrorOf(collapse));
  const bool counts_edges = options.stop == SimplifyStop::kCounts;
  if (counts_edges) CountRing(h, -1, sum);

  // The two other sides of a face that goes become one edge: a border if one of
  // them was.
  std::pair<VertexHandle, bool> merged[2];
  int num_merged = 0;
  for (const HalfedgeHandle side : {h, kernel.opposite_halfedge_handle(h)}) {
    if (kernel.is_boundary(side)) continue;
    const HalfedgeHandle next = kernel.next_halfedge_handle(side);
    const HalfedgeHandle prev = kernel.prev_halfedge_handle(side);
    merged[num_merged++] = {kernel.to_vertex_handle(next),
                            border[kernel.edge_handle(next).idx()] ||
                                border[kernel.edge_handle(prev).idx()]};
    --cluster_faces[label[kernel.face_handle(side).idx()]];
    --sum->faces;
  }
  kernel.collapse(h);
  ++sum->collapses;
  for (int i = 0; i < num_merged; ++i) {
    const EdgeHandle e =
        kernel.edge_handle(kernel.find_halfedge(to, merged[i].first));
    border[e.idx()] = merged[i].second;
  }
  vertices[to.idx()].position = collapse.target;
  quadric[to.idx()] += quadric[from.idx()];
  vertices[to.idx()].weight += vertices[from.idx()].weight;
  vertices[to.idx()].facing += vertices[from.idx()].facing;
  int degree = 0;
  for (const EdgeHandle e : kernel.ve_range(to)) degree += border[e.idx()];
  vertices[to.idx()].border_degree = degree;
  if (!counts_edges) return;
  for (const EdgeHandle e : kernel.ve_range(to)) {
    const EdgeClass edge_class = ClassOf(e);
    if (edge_class == kBorder) ++sum->border;
    if (edge_class == kInner) ++cluster_inner[ClusterOf(e)];
  }
}

// The cost that the given share of the candidates does not exceed, by a sample
// of them.
double Collapser::Impl::CostQuantile(double share) const {
  constexpr size_t kEvery = 61;  // of the edges
  std::vector<double> costs;
  for (size_t e = 0; e < kernel.n_edges(); e += kEvery) {
    const EdgeHandle edge(static_cast<int>(e));
    if (kernel.status(edge).deleted() || !MayCollapse(edge)) continue;
    costs.push_back(Plan(edge, 0).cost);
  }
  if (costs.empty()) return 0;
  const auto place =
      costs.begin() + static_cast<ptrdiff_t>(share * (costs.size() - 1));
  std::nth_element(costs.begin(), place, costs.end());
  return *place;
}

}  // namespace facet
