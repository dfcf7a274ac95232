// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "mesh/greedy_merge.h"

#include <algorithm>

#include "mesh/indexed_heap.h"
#include "mesh/union_find.h"
#include "util/fetch.h"
#include "util/huge_pages.h"

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
        clusters_(MakeClusters(energy_options, std::move(items))),
        sets_(clusters_.size()),
        links_(pairs.size()),
        heap_(pairs.size()) {
    for (size_t e = 0; e < pairs.size(); ++e) {
      Link& link = links_[e];
      link.end[0] = pairs[e].first;
      link.end[1] = pairs[e].second;
      for (int side = 0; side < 2; ++side) {
        Prepend(static_cast<int>(e), side);
        ++clusters_[link.end[side]].degree;
      }
      heap_.Set(static_cast<int>(e), Growth(link));
    }
  }

  void Run() {
    size_t clusters = clusters_.size();
    while (clusters > limits_.target && !heap_.Empty()) {
      if (limits_.max_growth > 0 && heap_.TopKey() > limits_.max_growth) break;
      const int link = heap_.Top();
      FetchNext();
      heap_.Remove(link);
      if (!heap_.Empty()) FetchLists(links_[heap_.Top()]);
      const int a = links_[link].end[0], b = links_[link].end[1];
      const SurfaceMoments both =
          Union(clusters_[a].moments, clusters_[b].moments);
      // Comes back when one of the two has changed.
      if (limits_.max_rms > 0 && RmsHeight(both) > limits_.max_rms) continue;
      if (clusters_[a].degree >= clusters_[b].degree) {
        Merge(a, b, both);
      } else {
        Merge(b, a, both);
      }
      --clusters;
    }
  }

  std::vector<int> Labels() {
    std::vector<int> label(clusters_.size()), id(clusters_.size(), -1);
    int count = 0;
    for (size_t i = 0; i < label.size(); ++i) {
      int& cluster = id[sets_.Find(static_cast<int>(i))];
      if (cluster < 0) cluster = count++;
      label[i] = cluster;
    }
    return label;
  }

 private:
  // All that a merge reads of a cluster, in two lines of the cache.
  struct alignas(128) Cluster {
    SurfaceMoments moments;
    double energy = 0;
    int head = -1;  // of its list of links
    int degree = 0;
    int mark = -1;  // the last merge that made it a neighbour
  };

  // A pair of adjacent clusters, in the singly linked lists of both. A dead
  // link stays in the other cluster's list until that is walked next.
  struct Link {
    int end[2];   // clusters; end[0] < 0 = dead
    int next[2];  // in the list of end[k], -1 = last
    bool Dead() const { return end[0] < 0; }
    // Of a link dead or alive.
    int Side(int cluster) const {
      return (Dead() ? ~end[0] : end[0]) == cluster ? 0 : 1;
    }
  };

  // A link of a cluster that takes part in a merge.
  struct Spoke {
    int link, side, other;
  };

  static HugeVector<Cluster> MakeClusters(const ClusterEnergyOptions& options,
                                          std::vector<SurfaceMoments> items) {
    HugeVector<Cluster> clusters(items.size());
    for (size_t i = 0; i < items.size(); ++i) {
      clusters[i].moments = items[i];
      clusters[i].energy = ClusterEnergy(options, items[i]);
    }
    return clusters;
  }

  // Asks for what a merge will read: on meshes of millions of faces all of it
  // comes from memory.
  FACET_FETCH void Fetch(int cluster) const {
    const char* at = reinterpret_cast<const char*>(&clusters_[cluster]);
    __builtin_prefetch(at);
    __builtin_prefetch(at + 64);
  }
  FACET_FETCH void FetchNext() const {
    for (int place = 1; place <= 20; ++place) {
      const int link = heap_.Peek(place);
      if (link < 0) break;
      if (place > 4) {
        __builtin_prefetch(&links_[link]);
      } else {
        Fetch(links_[link].end[0]);
        Fetch(links_[link].end[1]);
      }
    }
  }

  // The first links of the two clusters that are likely to merge next.
  FACET_FETCH void FetchLists(const Link& next) const {
    for (const int end : next.end) {
      const int head = clusters_[end].head;
      __builtin_prefetch(&links_[std::max(0, head)]);
    }
  }

  void Prepend(int link, int side) {
    int& head = clusters_[links_[link].end[side]].head;
    links_[link].next[side] = head;
    head = link;
  }

  double Growth(const Link& link) const {
    const Cluster &a = clusters_[link.end[0]], &b = clusters_[link.end[1]];
    return ClusterEnergy(options_, Union(a.moments, b.moments)) - a.energy -
           b.energy;
  }

  void Kill(int link) {
    heap_.Remove(link);
    for (const int end : links_[link].end) --clusters_[end].degree;
    // The complement marks it as dead, and Side() can still tell its sides.
    links_[link].end[0] = ~links_[link].end[0];
  }

  // b becomes part of a.
  void Merge(int a, int b, const SurfaceMoments& both) {
    TakeList(a, &own_);
    TakeList(b, &absorbed_);
    clusters_[a].moments = both;
    clusters_[a].energy = ClusterEnergy(options_, both);
    sets_.Attach(b, a);
    ++stamp_;
    for (size_t i = 0; i < own_.size(); ++i) {
      FetchEntry(own_, i);
      KeepOwn(b, own_[i]);
    }
    for (size_t i = 0; i < absorbed_.size(); ++i) {
      FetchEntry(absorbed_, i);
      Absorb(a, absorbed_[i]);
    }
  }

  // Empties the list of a cluster into `spokes`, without dead links.
  void TakeList(int cluster, std::vector<Spoke>* spokes) {
    spokes->clear();
    int link = clusters_[cluster].head;
    clusters_[cluster].head = -1;
    while (link >= 0) {
      const Link& l = links_[link];
      const int side = l.Side(cluster);
      if (!l.Dead()) {
        const int other = l.end[1 - side];
        Fetch(other);
        heap_.FetchPlace(link);
        spokes->push_back({link, side, other});
      }
      link = l.next[side];
    }
  }

  FACET_FETCH void FetchEntry(const std::vector<Spoke>& spokes,
                              size_t i) const {
    if (i == 0) {
      for (size_t k = 0; k < std::min<size_t>(4, spokes.size()); ++k) {
        heap_.FetchEntry(spokes[k].link);
      }
    } else if (i + 3 < spokes.size()) {
      heap_.FetchEntry(spokes[i + 3].link);
    }
  }

  // A link of a: dropped if it goes to b, else it gets a new key.
  void KeepOwn(int b, const Spoke& spoke) {
    if (links_[spoke.link].Dead()) return;
    if (spoke.other == b) {
      Kill(spoke.link);
      return;
    }
    clusters_[spoke.other].mark = stamp_;
    Prepend(spoke.link, spoke.side);
    heap_.Set(spoke.link, Growth(links_[spoke.link]));
  }

  // A link of b: becomes one of a, unless a has one to the same cluster.
  void Absorb(int a, const Spoke& spoke) {
    if (links_[spoke.link].Dead()) return;
    if (clusters_[spoke.other].mark == stamp_) {
      Kill(spoke.link);
      return;
    }
    clusters_[spoke.other].mark = stamp_;
    links_[spoke.link].end[spoke.side] = a;
    ++clusters_[a].degree;
    Prepend(spoke.link, spoke.side);
    heap_.Set(spoke.link, Growth(links_[spoke.link]));
  }

  const GreedyLimits limits_;
  const ClusterEnergyOptions options_;
  HugeVector<Cluster> clusters_;
  UnionFind sets_;
  HugeVector<Link> links_;
  IndexedHeap heap_;
  std::vector<Spoke> own_, absorbed_;  // of the present merge
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
