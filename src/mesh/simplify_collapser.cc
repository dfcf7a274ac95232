// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Which collapses are admissible, what they do, and in which order they come.
#include <algorithm>
#include <cmath>
#include <limits>

#include "mesh/simplify_kernel.h"

namespace facet {

EdgeClass Collapser::Impl::ClassOf(EdgeHandle e) const {
  if (border[e.idx()]) return kBorder;
  const HalfedgeHandle h = kernel.halfedge_handle(e, 0);
  const int ends = (border_degree[kernel.from_vertex_handle(h).idx()] > 0) +
                   (border_degree[kernel.to_vertex_handle(h).idx()] > 0);
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
                           : border_degree[v] > 0;
  };
  if (fixed(from) || (!fixed(to) && border_degree[from] > border_degree[to])) {
    std::swap(from, to);
    plan.halfedge = kernel.opposite_halfedge_handle(plan.halfedge);
  }
  plan.fixed_target = fixed(to);
  const Quadric q = quadric[from] + quadric[to];
  const Eigen::Vector3d& a = position[from];
  const Eigen::Vector3d& b = position[to];
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

// Link condition on the mesh (OpenMesh) and on the labels.
bool Collapser::Impl::LinkAllows(const Collapse& collapse) const {
  const HalfedgeHandle h = collapse.halfedge;
  // is_collapse_ok only tags status bits of the one-rings: logically const.
  if (!const_cast<Kernel&>(kernel).is_collapse_ok(h)) return false;
  const VertexHandle from = kernel.from_vertex_handle(h);
  const VertexHandle to = kernel.to_vertex_handle(h);
  // A closed tetrahedron passes the test of the one-rings.
  if (kernel.valence(from) == 3 && kernel.valence(to) == 3) return false;

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
  return true;
}

bool Collapser::Impl::ShapeAllows(const Collapse& collapse,
                                  const ShapeLimits& limits) const {
  const VertexHandle from = kernel.from_vertex_handle(collapse.halfedge);
  const VertexHandle to = kernel.to_vertex_handle(collapse.halfedge);
  const Eigen::Vector3d kept = facing[from.idx()] + facing[to.idx()];
  for (const VertexHandle moved : {from, to}) {
    const VertexHandle other = moved == from ? to : from;
    if (moved == to && collapse.target == position[to.idx()]) continue;
    for (auto it = kernel.cvoh_iter(moved); it.is_valid(); ++it) {
      if (kernel.is_boundary(*it)) continue;
      const VertexHandle v2 = kernel.to_vertex_handle(*it);
      const VertexHandle v3 =
          kernel.to_vertex_handle(kernel.next_halfedge_handle(*it));
      if (v2 == other || v3 == other) continue;
      if (!MayMoveCorner(position[moved.idx()],
                         collapse.target,
                         position[v2.idx()],
                         position[v3.idx()],
                         kept + facing[v2.idx()] + facing[v3.idx()],
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
  return std::sqrt(collapse.cost / (weight[from] + weight[to]));
}

// Adds `sign` to the counts of edges at both ends of h.
void Collapser::Impl::CountRing(HalfedgeHandle h, int sign) {
  const VertexHandle from = kernel.from_vertex_handle(h);
  const VertexHandle to = kernel.to_vertex_handle(h);
  for (const VertexHandle v : {from, to}) {
    for (const EdgeHandle e : kernel.ve_range(v)) {
      if (v == to && e == kernel.edge_handle(h)) continue;
      const EdgeClass edge_class = ClassOf(e);
      if (edge_class == kBorder) num_border += sign;
      if (edge_class == kInner) cluster_inner[ClusterOf(e)] += sign;
    }
  }
}

void Collapser::Impl::Execute(const Collapse& collapse) {
  const HalfedgeHandle h = collapse.halfedge;
  const VertexHandle from = kernel.from_vertex_handle(h);
  const VertexHandle to = kernel.to_vertex_handle(h);
  max_error = std::max(max_error, ErrorOf(collapse));
  CountRing(h, -1);

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
    --num_faces;
  }
  kernel.collapse(h);
  ++num_collapses;
  for (int i = 0; i < num_merged; ++i) {
    const EdgeHandle e =
        kernel.edge_handle(kernel.find_halfedge(to, merged[i].first));
    border[e.idx()] = merged[i].second;
  }
  position[to.idx()] = collapse.target;
  quadric[to.idx()] += quadric[from.idx()];
  weight[to.idx()] += weight[from.idx()];
  facing[to.idx()] += facing[from.idx()];
  int degree = 0;
  for (const EdgeHandle e : kernel.ve_range(to)) degree += border[e.idx()];
  border_degree[to.idx()] = degree;
  for (const EdgeHandle e : kernel.ve_range(to)) {
    const EdgeClass edge_class = ClassOf(e);
    if (edge_class == kBorder) ++num_border;
    if (edge_class == kInner) ++cluster_inner[ClusterOf(e)];
  }
  Requeue(to);
}

void Collapser::Impl::Push(EdgeHandle e) {
  rejected[e.idx()] = 0;
  attempt[e.idx()] = 0;
  if (MayCollapse(e)) {
    queue.Set(e.idx(), Plan(e, 0).cost);
  } else {
    queue.Remove(e.idx());
  }
}

// After a collapse: the edges of the kept vertex have new costs, and edges
// around it that were rejected may have become valid.
void Collapser::Impl::Requeue(VertexHandle kept) {
  for (auto it = kernel.cvoh_iter(kept); it.is_valid(); ++it) {
    Push(kernel.edge_handle(*it));
  }
  for (auto it = kernel.cvoh_iter(kept); it.is_valid(); ++it) {
    for (const EdgeHandle e : kernel.ve_range(kernel.to_vertex_handle(*it))) {
      if (rejected[e.idx()]) Push(e);
    }
  }
}

void Collapser::Impl::Fill(int classes) {
  active = classes;
  queue = IndexedHeap(kernel.n_edges());
  for (const EdgeHandle e : kernel.edges()) Push(e);  // skips deleted edges
}

// Collapses the cheapest valid candidate for which wanted(edge, plan) holds
// until done() or the queue is empty. Attempts 0 to 3 of an edge are its
// targets within the soft limits of shape, 4 to 7 the same within the hard
// ones, where it waits at shape_penalty times its cost.
template <typename Wanted, typename Done>
void Collapser::Impl::Run(const Wanted& wanted, const Done& done) {
  while (!queue.Empty() && !done()) {
    const EdgeHandle e(queue.Top());
    if (kernel.status(e).deleted()) {
      queue.Remove(e.idx());
      continue;
    }
    const int tried = attempt[e.idx()];
    const bool soft = tried < kNumTargets;
    const Collapse plan = Plan(e, tried % kNumTargets);
    if (!(ErrorOf(plan) <= options.max_error_m) || !wanted(e, plan)) {
      queue.Remove(e.idx());
    } else if (!LinkAllows(plan)) {
      Reject(e);
    } else if (ShapeAllows(plan, soft ? soft_limits : hard_limits)) {
      queue.Remove(e.idx());
      Execute(plan);
    } else {
      Retry(e, plan.fixed_target);
    }
  }
}

void Collapser::Impl::Reject(EdgeHandle e) {
  queue.Remove(e.idx());
  rejected[e.idx()] = 1;
}

void Collapser::Impl::Retry(EdgeHandle e, bool fixed_target) {
  int next = attempt[e.idx()] + 1;
  if (fixed_target) next = next <= kNumTargets ? kNumTargets : 2 * kNumTargets;
  const bool soft = next < kNumTargets;
  if (next == 2 * kNumTargets || (!soft && options.shape_penalty == 0)) {
    Reject(e);
    return;
  }
  attempt[e.idx()] = static_cast<uint8_t>(next);
  queue.Set(
      e.idx(),
      (soft ? 1 : options.shape_penalty) * Plan(e, next % kNumTargets).cost);
}

Collapser::Collapser(const TriMesh& mesh,
                     const PlanarPartition& partition,
                     const SimplifyOptions& options)
    : impl_(std::make_unique<Impl>(mesh, partition, options)) {}

Collapser::~Collapser() = default;

void Collapser::RunCounts() {
  Impl& m = *impl_;
  const double goal = std::max<double>(m.options.min_border_edges,
                                       m.options.border_ratio * m.num_border);
  const auto always = [](EdgeHandle, const Collapse&) { return true; };
  for (int pass = 0; pass < m.options.passes; ++pass) {
    m.Fill(kInner);
    m.Run(
        [&m](EdgeHandle e, const Collapse&) {
          return m.cluster_inner[m.ClusterOf(e)] > m.options.inner_target;
        },
        [] { return false; });
    m.Fill(kBorder);
    m.Run(always, [&m, goal] { return m.num_border <= goal; });
  }
  m.RemoveFlatFaces();
}

void Collapser::RunBudget() {
  Impl& m = *impl_;
  const bool by_area = m.options.target_faces == 0;
  const double budget =
      by_area ? m.options.faces_per_m2 * m.total_area : m.options.target_faces;
  const double max_cost =
      by_area ? m.options.max_cost_m4 : std::numeric_limits<double>::max();
  m.Fill(kInner | kBorder);
  m.Run(
      [&m, budget, max_cost](EdgeHandle, const Collapse& plan) {
        return (m.num_faces > budget && plan.cost <= max_cost) ||
               m.ErrorOf(plan) < m.options.free_error_m;
      },
      [] { return false; });
  m.RemoveFlatFaces();
}

}  // namespace facet
