// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "mesh/greedy_merge.h"

#include "mesh/indexed_heap.h"
#include "mesh/union_find.h"

namespace facet {
namespace {

class GreedyMerger {
 public:
  GreedyMerger(const GreedyLimits& limits,
               const ClusterEnergyOptions& energy_options,
               std::vector<SurfaceMoments> items,
               std::vector<std::pair<int, int>> pairs)
      : limits_(limits),
        options_(energy_options),
        moments_(std::move(items)),
        energy_(moments_.size()),
        head_(moments_.size(), -1),
        degree_(moments_.size(), 0),
        mark_(moments_.size(), -1),
        sets_(moments_.size()),
        links_(pairs.size()),
        heap_(pairs.size()) {
    for (size_t i = 0; i < moments_.size(); ++i) {
      energy_[i] = ClusterEnergy(options_, moments_[i]);
    }
    for (size_t e = 0; e < pairs.size(); ++e) {
      Link& link = links_[e];
      link.end[0] = pairs[e].first;
      link.end[1] = pairs[e].second;
      for (int side = 0; side < 2; ++side) {
        Prepend(static_cast<int>(e), side);
        ++degree_[link.end[side]];
      }
      heap_.Set(static_cast<int>(e), Growth(link));
    }
  }

  void Run() {
    size_t clusters = moments_.size();
    while (clusters > limits_.target && !heap_.Empty()) {
      if (limits_.max_growth > 0 && heap_.TopKey() > limits_.max_growth) break;
      const int link = heap_.Top();
      heap_.Remove(link);
      const int a = links_[link].end[0], b = links_[link].end[1];
      const SurfaceMoments both = Union(moments_[a], moments_[b]);
      // Comes back when one of the two has changed.
      if (limits_.max_rms > 0 && RmsHeight(both) > limits_.max_rms) continue;
      if (degree_[a] >= degree_[b]) {
        Merge(a, b, both);
      } else {
        Merge(b, a, both);
      }
      --clusters;
    }
  }

  std::vector<int> Labels() {
    std::vector<int> label(moments_.size()), id(moments_.size(), -1);
    int count = 0;
    for (size_t i = 0; i < label.size(); ++i) {
      int& cluster = id[sets_.Find(static_cast<int>(i))];
      if (cluster < 0) cluster = count++;
      label[i] = cluster;
    }
    return label;
  }

 private:
  // A pair of adjacent clusters, in the singly linked lists of both. A dead
  // link stays in the other cluster's list until that is walked next.
  struct Link {
    int end[2];   // clusters; end[0] < 0 = dead
    int next[2];  // in the list of end[k], -1 = last
    int Side(int cluster) const { return end[0] == cluster ? 0 : 1; }
  };

  void Prepend(int link, int side) {
    int& head = head_[links_[link].end[side]];
    links_[link].next[side] = head;
    head = link;
  }

  double Growth(const Link& link) const {
    const int a = link.end[0], b = link.end[1];
    return ClusterEnergy(options_, Union(moments_[a], moments_[b])) -
           energy_[a] - energy_[b];
  }

  void Kill(int link) {
    heap_.Remove(link);
    for (int side = 0; side < 2; ++side) --degree_[links_[link].end[side]];
    // The complement marks it as dead, and Next() can still tell its sides.
    links_[link].end[0] = ~links_[link].end[0];
  }

  // b becomes part of a.
  void Merge(int a, int b, const SurfaceMoments& both) {
    moments_[a] = both;
    energy_[a] = ClusterEnergy(options_, both);
    sets_.Attach(b, a);
    ++stamp_;
    WalkOwn(a, b);
    WalkAbsorbed(a, b);
  }

  static bool Dead(const Link& link) { return link.end[0] < 0; }

  // Where the list of `cluster` goes on after `link`, dead or alive.
  int Next(int link, int cluster) const {
    const Link& l = links_[link];
    const int first = l.end[0] < 0 ? ~l.end[0] : l.end[0];
    return l.next[first == cluster ? 0 : 1];
  }

  // Drops the dead links of a and those to b, marks its neighbours, renews the
  // keys.
  void WalkOwn(int a, int b) {
    int link = head_[a];
    head_[a] = -1;
    while (link >= 0) {
      const int next = Next(link, a);
      if (!Dead(links_[link])) {
        const int side = links_[link].Side(a);
        const int other = links_[link].end[1 - side];
        if (other == b) {
          Kill(link);
        } else {
          mark_[other] = stamp_;
          Prepend(link, side);
          heap_.Set(link, Growth(links_[link]));
        }
      }
      link = next;
    }
  }

  // Moves the links of b to a, except those to clusters that a has already.
  void WalkAbsorbed(int a, int b) {
    int link = head_[b];
    head_[b] = -1;
    while (link >= 0) {
      const int next = Next(link, b);
      if (!Dead(links_[link])) {
        const int side = links_[link].Side(b);
        const int other = links_[link].end[1 - side];
        if (mark_[other] == stamp_) {
          Kill(link);
        } else {
          mark_[other] = stamp_;
          links_[link].end[side] = a;
          ++degree_[a];
          Prepend(link, side);
          heap_.Set(link, Growth(links_[link]));
        }
      }
      link = next;
    }
  }

  const GreedyLimits limits_;
  const ClusterEnergyOptions options_;
  std::vector<SurfaceMoments> moments_;
  std::vector<double> energy_;
  std::vector<int> head_, degree_, mark_;
  UnionFind sets_;
  std::vector<Link> links_;
  IndexedHeap heap_;
  int stamp_ = 0;
};

}  // namespace

std::vector<int> MergeGreedily(const GreedyLimits& limits,
                               const ClusterEnergyOptions& energy,
                               std::vector<SurfaceMoments> items,
                               std::vector<std::pair<int, int>> pairs) {
  GreedyMerger merger(limits, energy, std::move(items), std::move(pairs));
  merger.Run();
  return merger.Labels();
}

}  // namespace facet
