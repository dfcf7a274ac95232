// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The collapses of one region, or of the whole mesh, in order. Internal to the
// simplification.
#pragma once

#include "mesh/indexed_heap.h"
#include "mesh/simplify_kernel.h"

namespace facet {

// Tasks of different regions may run at the same time. That of the whole mesh
// runs alone.
class CollapseTask {
 public:
  // Edges inside `region`; with kWholeMesh all edges.
  static constexpr int kWholeMesh = -1;
  CollapseTask(Collapser::Impl* impl, int region);

  // Queues what may collapse.
  void Fill();

  // Collapses the cheapest valid candidate for which wanted(edge, plan) holds
  // until done() or the queue is empty.
  template <typename Wanted, typename Done>
  void Run(const Wanted& wanted, const Done& done);

  // Without the queue: collapses, in the order of the edges, those of at most
  // `max_cost`, at most one edge of a vertex, until `goal` faces are left.
  // `touched` is of all vertices. The task of the whole mesh leaves the insides
  // of the regions out.
  void Sweep(double max_cost, double goal, std::vector<uint8_t>* touched);

  bool HasMore(double max_cost) const {
    return !queue_.Empty() && queue_.TopKey() <= max_cost;
  }
  // Faces left with two corners inside the region, which is what its collapses
  // take away.
  int Faces() const { return faces_before_ + changes_.faces; }

  // What this task has changed so far.
  const Counts& Changes() const { return changes_; }

 private:
  bool IsMine(EdgeHandle e) const {
    return region_ == kWholeMesh || m_.IsInside(e, region_);
  }
  int CountFaces() const;
  void Push(EdgeHandle e);
  void Remove(EdgeHandle e) { queue_.Remove(e.idx() - first_edge_); }
  void Requeue(VertexHandle kept);
  void Reject(EdgeHandle e);
  void Retry(EdgeHandle e, bool fixed_target);

  Collapser::Impl& m_;
  const int region_;
  const int first_edge_, end_edge_;
  int faces_before_ = 0;
  IndexedHeap queue_;  // edges from first_edge_ on, by cost
  Counts changes_;
};

// Attempts 0 to 3 of an edge are its targets within the soft limits of shape, 4
// to 7 the same within the hard ones, where it waits at shape_penalty times its
// cost.
template <typename Wanted, typename Done>
void CollapseTask::Run(const Wanted& wanted, const Done& done) {
  while (!queue_.Empty() && !done()) {
    const EdgeHandle e(first_edge_ + queue_.Top());
    if (m_.kernel.status(e).deleted()) {
      Remove(e);
      continue;
    }
    const int tried = m_.attempt[e.idx()];
    const bool soft = tried < kNumTargets;
    const Collapse plan = m_.Plan(e, tried % kNumTargets);
    if (!(m_.ErrorOf(plan) <= m_.options.max_error_m) || !wanted(e, plan)) {
      Remove(e);
    } else if (!m_.LinkAllows(plan)) {
      Reject(e);
    } else if (m_.ShapeAllows(plan, soft ? m_.soft_limits : m_.hard_limits)) {
      Remove(e);
      m_.Execute(plan, &changes_);
      Requeue(m_.kernel.to_vertex_handle(plan.halfedge));
    } else {
      Retry(e, plan.fixed_target);
    }
  }
}

}  // namespace facet
