// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// In which order the collapses come: inside the regions at the same time, then
// over the whole mesh.
#include <algorithm>
#include <limits>
#include <memory>
#include <vector>

#include "mesh/simplify_task.h"
#include "util/parallel_for.h"

namespace facet {
namespace {

using Tasks = std::vector<std::unique_ptr<CollapseTask>>;

// When this share of the faces is left, four regions become one, and so on:
// queues stay small, and seams do not lag behind so far that it costs shape.
constexpr int kGroup = 4;
constexpr double kLeaveToGroups = 0.6;
// Sweeps need no queue: larger regions, shorter seams.
constexpr int kSweepGroup = 8;
// Regions stop at this many times the budget: what is collapsed last must be
// the cheapest of the whole mesh.
constexpr double kLeaveToWhole = 4;
constexpr double kCostStep = 4;  // of the limit, from round to round

int Faces(const Tasks& tasks) {
  int faces = 0;
  for (const auto& task : tasks) faces += task->Faces();
  return faces;
}

}  // namespace

void Collapser::Impl::GroupRegions(int size) {
  // First the vertices with all their faces in a region; of these, those whose
  // ring is made of such vertices.
  constexpr int kNone = -1, kSeam = -2;
  group_size = size;
  for (VertexData& v : vertices) v.region = kNone;
  const auto corners = [&](int f, auto&& visit) {
    const OpenMesh::FaceHandle face(f);
    if (kernel.status(face).deleted()) return;
    for (const VertexHandle v : kernel.fv_range(face)) {
      visit(&vertices[v.idx()].region);
    }
  };
  for (int r = 0; r < NumRegions(); ++r) {
    for (int f = first_face[FirstLeaf(r)]; f < first_face[FirstLeaf(r + 1)];
         ++f) {
      corners(f, [&](int* region) {
        *region = *region == kNone || *region == r ? r : kSeam;
      });
    }
  }
  for (int f = 0; f < static_cast<int>(label.size()); ++f) {
    bool seam = false;
    corners(f, [&](const int* region) { seam |= *region == kSeam; });
    if (!seam) continue;
    corners(f, [&](int* region) {
      if (*region != kSeam) *region = kNone;
    });
  }
}

// Collapses, region by region, what is among the cheapest half, then what lies
// between them. Returns whether that took a tenth of the faces away.
bool Collapser::Impl::Sweep(double goal, double max_cost) {
  const double limit = std::min(CostQuantile(0.5), max_cost);
  const int before = counts.faces;
  // Only a region that is simpler than others gets as far as its share of the
  // goal; the next sweep divides what is left.
  const double share = goal / before;
  std::vector<uint8_t> touched(vertices.size(), 0);
  std::vector<Counts> changes(NumRegions());
  ParallelFor(0, NumRegions(), [&](size_t r) {
    CollapseTask task(this, static_cast<int>(r));
    task.Sweep(limit, share * task.Faces(), &touched);
    changes[r] = task.Changes();
  });
  for (const Counts& c : changes) counts.Add(c);
  CollapseTask seams(this, CollapseTask::kWholeMesh);
  seams.Sweep(limit, goal, &touched);
  counts.Add(seams.Changes());
  return counts.faces < 0.9 * before;
}

// Rounds of growing cost, as the order by cost has it, until not much more than
// `budget` would be left if the seams were as far. Returns whether it was
// stopped by that or `max_cost`.
bool Collapser::Impl::RunRounds(double goal,
                                double budget,
                                double max_cost,
                                double* limit) {
  Tasks tasks(NumRegions());
  ParallelFor(0, tasks.size(), [&](size_t r) {
    tasks[r] = std::make_unique<CollapseTask>(this, static_cast<int>(r));
    tasks[r]->Fill();
  });
  const double seams = counts.faces / std::max<double>(1, Faces(tasks));
  const double stop = kLeaveToWhole * budget;
  bool done = false;
  while (!done) {
    // What the whole mesh would have if its seams were as far.
    const double faces = seams * Faces(tasks);
    done = faces <= stop;
    if (faces <= std::max(stop, goal)) break;
    *limit = std::min(*limit, max_cost);
    // No round ends below the budget, however many collapses are cheap.
    const double share = 0.5 * (1 + kLeaveToWhole) * budget / faces;
    ParallelFor(0, tasks.size(), [&](size_t r) {
      CollapseTask& task = *tasks[r];
      const double least = share * task.Faces();
      task.Run(
          [&](EdgeHandle, const Collapse& plan) {
            return plan.cost <= max_cost ||
                   ErrorOf(plan) < options.free_error_m;
          },
          [&] { return !task.HasMore(*limit) || task.Faces() <= least; });
    });
    const bool more =
        std::any_of(tasks.begin(), tasks.end(), [](const auto& t) {
          return t->HasMore(std::numeric_limits<double>::max());
        });
    if (!more) break;
    done = *limit >= max_cost;
    *limit *= kCostStep;
  }
  for (const auto& task : tasks) counts.Add(task->Changes());
  return done;
}

// The collapses inside regions, which grow as the faces become fewer.
void Collapser::Impl::CollapseInside(double budget, double max_cost) {
  double limit = std::max(CostQuantile(0.25), 1e-30);
  for (int size = 1; size < NumLeaves(); size *= kGroup) {
    GroupRegions(size);
    if (RunRounds(kLeaveToGroups * counts.faces, budget, max_cost, &limit)) {
      break;
    }
    limit /= kCostStep;  // the seams have to catch up
  }
}

// Step 1 inside the regions. A cluster at a seam is left several times the
// edges at the seam, which the cheapest of the whole cluster are taken from
// later.
void Collapser::Impl::CollapseInnerInside() {
  if (NumLeaves() < 2) return;
  GroupRegions(kSweepGroup);
  constexpr int kLeave = 4;
  std::vector<int> goal(cluster_inner.size(), options.inner_target);
  for (const EdgeHandle e : kernel.edges()) {
    if (ClassOf(e) != kInner || IsInsideAny(e)) continue;
    goal[ClusterOf(e)] += kLeave;
  }
  active = kInner;
  std::vector<Counts> changes(NumRegions());
  ParallelFor(0, NumRegions(), [&](size_t r) {
    CollapseTask task(this, static_cast<int>(r));
    task.Fill();
    task.Run(
        [&](EdgeHandle e, const Collapse&) {
          const int id = ClusterOf(e);
          return cluster_inner[id] > goal[id];
        },
        [] { return false; });
    changes[r] = task.Changes();
  });
  for (const Counts& c : changes) counts.Add(c);
}

Collapser::Collapser(const TriMesh& mesh,
                     const PlanarPartition& partition,
                     const SimplifyOptions& options,
                     int faces_per_region)
    : impl_(
          std::make_unique<Impl>(mesh, partition, options, faces_per_region)) {}

Collapser::~Collapser() = default;

void Collapser::RunCounts() {
  Impl& m = *impl_;
  const double goal = std::max<double>(
      m.options.min_border_edges, m.options.border_ratio * m.counts.border);
  for (int pass = 0; pass < m.options.passes; ++pass) {
    m.CollapseInnerInside();
    m.active = kInner;
    CollapseTask inner(&m, CollapseTask::kWholeMesh);
    inner.Fill();
    inner.Run(
        [&](EdgeHandle e, const Collapse&) {
          return m.cluster_inner[m.ClusterOf(e)] > m.options.inner_target;
        },
        [] { return false; });
    m.counts.Add(inner.Changes());
    m.active = kBorder;
    CollapseTask borders(&m, CollapseTask::kWholeMesh);
    borders.Fill();
    borders.Run(
        [](EdgeHandle, const Collapse&) { return true; },
        [&] { return m.counts.border + borders.Changes().border <= goal; });
    m.counts.Add(borders.Changes());
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
  m.active = kInner | kBorder;
  const double few = m.options.sweep_ratio * budget;
  if (m.counts.faces > few) m.GroupRegions(kSweepGroup);
  while (few > 0 && m.counts.faces > few && m.Sweep(few, max_cost)) {
  }
  m.CollapseInside(budget, max_cost);
  CollapseTask whole(&m, CollapseTask::kWholeMesh);
  whole.Fill();
  whole.Run(
      [&](EdgeHandle, const Collapse& plan) {
        return (whole.Faces() > budget && plan.cost <= max_cost) ||
               m.ErrorOf(plan) < m.options.free_error_m;
      },
      [] { return false; });
  m.counts.Add(whole.Changes());
  m.RemoveFlatFaces();
}

}  // namespace facet
