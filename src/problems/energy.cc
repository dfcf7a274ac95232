// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "problems/energy.h"

#include <algorithm>
#include <cmath>

#include "costs/plane_manifold.h"
#include "problems/tile_samples.h"
#include "util/parallel_for.h"

namespace facet {
namespace {

struct ResidualSums {
  double squares = 0;
  PhotoCounts counts;
};

// Sum of rho of the residuals of all channels against the state's colours; raw:
// of the squared residuals of the unsmoothed luma against the means of what is
// sampled.
ResidualSums SumResiduals(const TextureProblem& problem,
                          const ReconState& state,
                          bool raw) {
  std::vector<PhotoChannel> channels;
  if (raw) {
    channels.push_back(
        MakePhotoChannel(problem, state, PointsAt::kPlane, true, 0));
  } else {
    channels = MakePhotoChannels(problem, state, PointsAt::kPlane);
  }
  std::vector<double> squares(problem.tiles.size());
  ResidualSums total;
  total.counts = ForEachTile(
      problem,
      channels,
      {},
      [&](size_t t, const std::vector<TileSamples>* samples) {
        const TexelTile& tile = problem.tiles[t];
        const float* colors = state.colors.data() + tile.texel_begin;
        for (const TileSamples& channel : *samples) {
          squares[t] += SumLoss(
              problem, tile, channel, raw ? channel.mean.data() : colors);
          colors += problem.texels.size();
        }
      });
  for (const double s : squares) total.squares += s;
  return total;
}

double SumPlaneDistances(const TextureProblem& problem,
                         const ReconState& state) {
  double sum = 0;
  for (int j = 0; j < problem.NumPlanes(); ++j) {
    const Eigen::Map<const Eigen::Vector4d> phi(state.planes.data() +
                                                kPlaneSize * j);
    sum += std::max(0.0, phi.dot(problem.moments[j] * phi));
  }
  return sum;
}

}  // namespace

double EnergyTerms::SumOfTerms() const {
  double sum = 0;
  for (const NamedEnergy& term : e_terms) sum += term.value;
  return sum;
}

double EnergyTerms::RmsIntensity() const {
  return observations == 0 ? 0.0
                           : std::sqrt(e_c / texel_weight /
                                       static_cast<double>(observations));
}

double EnergyTerms::ClampedShare() const {
  return observations == 0
             ? 0.0
             : static_cast<double>(clamped) / static_cast<double>(observations);
}

EnergyTerms EvaluateEnergy(const TextureProblem& problem,
                           const EnergyWeights& weights,
                           const ReconState& state,
                           bool with_rms_grey) {
  ResidualSums sums = SumResiduals(problem, state, false);
  sums.squares /= problem.NumChannels();
  EnergyTerms terms;
  terms.texel_weight = weights.texel_weight;
  terms.e_c = weights.texel_weight * sums.squares;
  terms.e_p = weights.texel_weight * SumPlaneDistances(problem, state);
  for (const double f : state.warps) terms.e_s += f * f;
  terms.e_prior = EvaluateTerm(PosePriorTerm(problem, weights), state);
  terms.e_depth = EvaluateTerm(DepthTerm(problem, weights), state);
  for (const Term& term : problem.terms) {
    terms.e_terms.push_back({term.name, EvaluateTerm(term, state)});
  }
  terms.e_tex =
      terms.e_c + weights.lambda1 * terms.e_p + weights.lambda2 * terms.e_s;
  terms.observations = sums.counts.used;
  terms.clamped = sums.counts.clamped;
  terms.behind = sums.counts.behind;
  terms.lost = sums.counts.lost;
  if (with_rms_grey && terms.observations > 0) {
    const ResidualSums raw = SumResiduals(problem, state, true);
    terms.rms_grey =
        255 * std::sqrt(raw.squares / static_cast<double>(raw.counts.used));
  }
  return terms;
}

double InitialLambda1(const TextureProblem& problem,
                      const EnergyWeights& weights,
                      const ReconState& initial_state) {
  const EnergyTerms terms = EvaluateEnergy(problem, weights, initial_state);
  double texels = 0;  // the last element of a moment counts its points
  for (const Eigen::Matrix4d& moment : problem.moments) texels += moment(3, 3);
  const double floor = weights.texel_weight * texels * 0.0005 * 0.0005;
  if (terms.e_c <= 0 || texels == 0) return 1e3;
  return weights.lambda1_share * terms.e_c / std::max(terms.e_p, floor);
}

double InitialPriorScale(const TextureProblem& problem,
                         const EnergyWeights& weights,
                         const ReconState& initial_state) {
  const EnergyTerms terms = EvaluateEnergy(problem, weights, initial_state);
  return std::sqrt(weights.prior_strength * terms.e_c /
                   std::max(1, problem.NumKeyframes()));
}

}  // namespace facet
