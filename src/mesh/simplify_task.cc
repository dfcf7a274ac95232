// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "mesh/simplify_task.h"

namespace facet {

CollapseTask::CollapseTask(Collapser::Impl* impl, int region)
    : m_(*impl),
      region_(region),
      first_edge_(region == kWholeMesh ? 0
                                       : m_.first_edge[m_.FirstLeaf(region)]),
      end_edge_(region == kWholeMesh ? m_.first_edge.back()
                                     : m_.first_edge[m_.FirstLeaf(region + 1)]),
      queue_(0) {
  faces_before_ = region == kWholeMesh ? m_.counts.faces : CountFaces();
}

int CollapseTask::CountFaces() const {
  int count = 0;
  const int end = m_.first_face[m_.FirstLeaf(region_ + 1)];
  for (int f = m_.first_face[m_.FirstLeaf(region_)]; f < end; ++f) {
    const OpenMesh::FaceHandle face(f);
    if (m_.kernel.status(face).deleted()) continue;
    int inside = 0;
    for (const VertexHandle v : m_.kernel.fv_range(face)) {
      inside += m_.vertices[v.idx()].region == region_;
    }
    count += inside >= 2;
  }
  return count;
}

void CollapseTask::Push(EdgeHandle e) {
  m_.rejected[e.idx()] = 0;
  m_.attempt[e.idx()] = 0;
  if (m_.MayCollapse(e)) {
    queue_.Set(e.idx() - first_edge_, m_.Plan(e, 0).cost);
  } else {
    Remove(e);
  }
}

// After a collapse: the edges of the kept vertex have new costs, and edges
// around it that were rejected may have become valid.
void CollapseTask::Requeue(VertexHandle kept) {
  m_.refused[kept.idx()] = 0;
  for (auto it = m_.kernel.cvoh_iter(kept); it.is_valid(); ++it) {
    const EdgeHandle e = m_.kernel.edge_handle(*it);
    if (IsMine(e)) Push(e);
  }
  for (auto it = m_.kernel.cvoh_iter(kept); it.is_valid(); ++it) {
    const VertexHandle v = m_.kernel.to_vertex_handle(*it);
    if (!m_.refused[v.idx()]) continue;
    m_.refused[v.idx()] = 0;
    for (const EdgeHandle e : m_.kernel.ve_range(v)) {
      if (m_.rejected[e.idx()] && IsMine(e)) Push(e);
    }
  }
}

void CollapseTask::Fill() {
  queue_ = IndexedHeap(end_edge_ - first_edge_);
  for (int i = first_edge_; i < end_edge_; ++i) {
    const EdgeHandle e(i);
    if (!m_.kernel.status(e).deleted() && IsMine(e)) Push(e);
  }
}

void CollapseTask::Reject(EdgeHandle e) {
  Remove(e);
  m_.rejected[e.idx()] = 1;
  const HalfedgeHandle h = m_.kernel.halfedge_handle(e, 0);
  m_.refused[m_.kernel.from_vertex_handle(h).idx()] = 1;
  m_.refused[m_.kernel.to_vertex_handle(h).idx()] = 1;
}

void CollapseTask::Retry(EdgeHandle e, bool fixed_target) {
  const double penalty = m_.options.shape_penalty;
  int next = m_.attempt[e.idx()] + 1;
  if (fixed_target) next = next <= kNumTargets ? kNumTargets : 2 * kNumTargets;
  const bool soft = next < kNumTargets;
  if (next == 2 * kNumTargets || (!soft && penalty == 0)) {
    Reject(e);
    return;
  }
  m_.attempt[e.idx()] = static_cast<uint8_t>(next);
  queue_.Set(e.idx() - first_edge_,
             (soft ? 1 : penalty) * m_.Plan(e, next % kNumTargets).cost);
}

void CollapseTask::Sweep(double max_cost,
                         double goal,
                         std::vector<uint8_t>* touched) {
  for (int i = first_edge_; i < end_edge_; ++i) {
    if (Faces() <= goal) break;
    const EdgeHandle e(i);
    if (m_.kernel.status(e).deleted() || !m_.MayCollapse(e)) continue;
    if (region_ == kWholeMesh ? m_.IsInsideAny(e) : !m_.IsInside(e, region_)) {
      continue;
    }
    const HalfedgeHandle h = m_.kernel.halfedge_handle(e, 0);
    uint8_t& from = (*touched)[m_.kernel.from_vertex_handle(h).idx()];
    uint8_t& to = (*touched)[m_.kernel.to_vertex_handle(h).idx()];
    if (from || to) continue;
    const Collapse plan = m_.Plan(e, 0);
    if (plan.cost <= max_cost && m_.ErrorOf(plan) <= m_.options.max_error_m &&
        m_.LinkAllows(plan) && m_.ShapeAllows(plan, m_.soft_limits)) {
      m_.Execute(plan, &changes_);
      from = to = 1;
    }
  }
}

}  // namespace facet
