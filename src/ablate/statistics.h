// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Means, spreads and paired differences. NaN stands for a figure that does not
// exist; it takes no part.
#pragma once

#include <vector>

namespace facet {

struct SampleStatistics {
  int n = 0;
  double mean = 0;    // NaN if n = 0
  double spread = 0;  // standard deviation with n - 1; NaN if n < 2
};

SampleStatistics StatisticsOf(const std::vector<double>& values);

// Of values[i] - reference[i], over the i for which both exist. Pairs share a
// scan (and so its seed and its noise), whose own effect cancels: the spread of
// the differences is the one to judge a difference of means by.
SampleStatistics PairedDifference(const std::vector<double>& values,
                                  const std::vector<double>& reference);

// The first time at which `energies` fell to initial - share (initial - best);
// NaN if they never did or best is not below initial. `times` and `energies`
// belong together, in order of time.
double TimeToReach(double share,
                   double initial,
                   double best,
                   const std::vector<double>& times,
                   const std::vector<double>& energies);

}  // namespace facet
