// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "ablate/statistics.h"

#include <cmath>
#include <limits>

namespace facet {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

}  // namespace

SampleStatistics StatisticsOf(const std::vector<double>& values) {
  SampleStatistics sample;
  double sum = 0;
  for (const double v : values) {
    if (std::isnan(v)) continue;
    sum += v;
    ++sample.n;
  }
  sample.mean = sample.n > 0 ? sum / sample.n : kNone;
  double squares = 0;
  for (const double v : values) {
    if (!std::isnan(v)) squares += (v - sample.mean) * (v - sample.mean);
  }
  sample.spread = sample.n > 1 ? std::sqrt(squares / (sample.n - 1)) : kNone;
  return sample;
}

SampleStatistics PairedDifference(const std::vector<double>& values,
                                  const std::vector<double>& reference) {
  std::vector<double> differences;
  for (size_t i = 0; i < values.size() && i < reference.size(); ++i) {
    differences.push_back(values[i] - reference[i]);
  }
  return StatisticsOf(differences);
}

double TimeToReach(double share,
                   double initial,
                   double best,
                   const std::vector<double>& times,
                   const std::vector<double>& energies) {
  if (!(best < initial)) return kNone;
  // The sum may differ from the energy that defines it in the last bits.
  const double target = initial - share * (initial - best) + 1e-12 * initial;
  for (size_t i = 0; i < times.size() && i < energies.size(); ++i) {
    if (energies[i] <= target) return times[i];
  }
  return kNone;
}

}  // namespace facet
