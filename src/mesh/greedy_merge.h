// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Greedy merging of adjacent pieces of surface by the growth of the cluster
// energy. Method, Sec. 2.3 and 2.4. Internal to mesh/partition.h.
#pragma once

#include <utility>
#include <vector>

#include "mesh/cluster_energy.h"
#include "mesh/covariance.h"

namespace facet {

struct GreedyLimits {
  size_t target = 1;      // stop at this many clusters
  double max_rms = 0;     // no union with a larger rms height [m]; 0 = off
  double max_growth = 0;  // stop when the cheapest union costs more; 0 = off
};

// Starts with every item as its own cluster and unites the adjacent pair with
// the least E(a u b) - E(a) - E(b) until a limit is reached or no pair is left.
// Equal costs: the pair that comes first in `pairs`. Returns the cluster of
// every item, 0-based in the order of their first items.
// Memory: about 220 bytes an item with 1.5 pairs an item, its arguments
// included.
std::vector<int> MergeGreedily(const GreedyLimits& limits,
                               const ClusterEnergyOptions& energy,
                               std::vector<SurfaceMoments> items,
                               std::vector<std::pair<int, int>> pairs);

}  // namespace facet
