// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The PCA energy of a cluster (paper, Sec. 3.1, after Cai et al. 2017; method,
// Sec. 2.2):
//
//   E = det(Cov) / A^4          if det(Cov) / A^5 >= tau
//   E = alpha tr(Cov) A         otherwise (numerically flat)
//   E = 0                       if A < 1e-10 m^2
//
// For compact clusters E is about 0.006 mu_3, the squared plane-fit error;
// ragged and disconnected ones pay more, because mu_1 mu_2 / A^4 grows.
#pragma once

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>

#include "mesh/covariance.h"

namespace facet {

enum class ClusterEnergyKind {
  kAuthors,     // as above; jumps at det / A^5 = tau
  kContinuous,  // max(0, det / A^4 - tau A) + alpha tr A
  kLambdaMin,   // mu_3, the smallest eigenvalue of Cov; no compactness
};

struct ClusterEnergyOptions {
  ClusterEnergyKind kind = ClusterEnergyKind::kAuthors;
  double alpha = 1e-20;  // weight of compactness when flat [m^-2]
  double tau = 1e-15;    // flatness threshold [m^2]
};

inline double ClusterEnergy(const ClusterEnergyOptions& options,
                            const SurfaceMoments& m) {
  if (m.area < 1e-10) return 0;
  if (options.kind == ClusterEnergyKind::kLambdaMin) {
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
    solver.computeDirect(m.Covariance(), Eigen::EigenvaluesOnly);
    return std::max(0.0, solver.eigenvalues()[0]);
  }
  const double square = m.area * m.area;
  const double scaled = std::max(0.0, m.Determinant()) / (square * square);
  const double compactness = options.alpha * m.Trace() * m.area;
  const double excess = scaled - options.tau * m.area;
  if (options.kind == ClusterEnergyKind::kContinuous) {
    return std::max(0.0, excess) + compactness;
  }
  return excess >= 0 ? scaled : compactness;
}

}  // namespace facet
