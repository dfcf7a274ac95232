// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The plane step in every parametrisation, against the distance of the world's
// origin from the plane's anchor. Manifolds are all that knows the origin
// (costs/plane_manifold.h), so it is moved by telling them another anchor; the
// costs, and with them the minimum, stay the same to the last bit.
//
//   remaining_1   (E - E_best) / (E_start - E_best) after one iteration, mean
//   over remaining_3   the planes; after three, as many as a phase Phi does
//   iterations    until that is below 1e-4, the worst plane; -1 = not in 50
//
// E is that of the plane with its normal brought to unit length.
#include <ceres/iteration_callback.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "benchmarks/bench_args.h"
#include "benchmarks/bench_scene.h"
#include "costs/plane_manifold.h"
#include "costs/plane_moment.h"
#include "costs/plane_photometric_cost.h"

namespace facet {
namespace {

constexpr int kMaxIterations = 50;

// Observations of plane j: texels are sorted by plane, observations by texel.
std::vector<PlaneSegment> SegmentsOf(const TextureProblem& problem, int j) {
  std::vector<PlaneSegment> segments;
  const auto before = [&](uint32_t texel, int plane) {
    return problem.texels.plane[texel] < plane;
  };
  for (int k = 0; k < problem.NumKeyframes(); ++k) {
    const uint32_t* ids = problem.observations.texel.data();
    const uint32_t* end = ids + problem.observations.begin[k + 1];
    const uint32_t* first =
        std::lower_bound(ids + problem.observations.begin[k], end, j, before);
    const uint32_t* last = std::lower_bound(first, end, j + 1, before);
    if (last > first) {
      segments.push_back({k, first, static_cast<size_t>(last - first)});
    }
  }
  return segments;
}

// E_c + lambda1 E_p of one plane.
class PlaneFit : public ceres::IterationCallback {
 public:
  PlaneFit(const BenchScene& bench, const PhotoChannel& channel, int j)
      : segments_(SegmentsOf(bench.scene.problem, j)),
        photometric_(
            channel.frames,
            segments_,
            channel.points.data(),
            bench.scene.problem.anchors[j] - bench.scene.problem.origin,
            bench.weights.texel_weight),
        moment_(bench.scene.problem.moments[j],
                bench.weights.texel_weight * bench.weights.lambda1) {}

  // Returns the energies at the start and after each iteration.
  std::vector<double> Solve(PlaneKind kind,
                            const Eigen::Vector3d& anchor,
                            const double* start) {
    std::copy(start, start + kPlaneSize, plane_);
    energies_.clear();
    ceres::Problem::Options keep;
    keep.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    ceres::Problem problem(keep);
    problem.AddParameterBlock(
        plane_, kPlaneSize, CreatePlaneManifold(kind, anchor));
    problem.AddResidualBlock(&photometric_, nullptr, plane_);
    problem.AddResidualBlock(&moment_, nullptr, plane_);
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_QR;
    options.max_num_iterations = kMaxIterations;
    options.max_num_consecutive_invalid_steps = kMaxIterations;
    options.function_tolerance = 0;
    options.gradient_tolerance = 0;
    options.parameter_tolerance = 0;
    options.logging_type = ceres::SILENT;
    options.update_state_every_iteration = true;
    options.callbacks.push_back(this);
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    energies_.resize(kMaxIterations + 1, energies_.back());
    return energies_;
  }

  ceres::CallbackReturnType operator()(
      const ceres::IterationSummary&) override {
    energies_.push_back(Energy());
    return ceres::SOLVER_CONTINUE;
  }

 private:
  double Energy() const {
    double unit[kPlaneSize];
    const Eigen::Map<const Eigen::Vector4d> phi(plane_);
    Eigen::Map<Eigen::Vector4d>(unit).noalias() = phi / phi.head<3>().norm();
    const double* parameters[] = {unit};
    double r[5], s[4];
    photometric_.Evaluate(parameters, r, nullptr);
    moment_.Evaluate(parameters, s, nullptr);
    return Eigen::Map<const Eigen::Matrix<double, 5, 1>>(r).squaredNorm() +
           Eigen::Map<const Eigen::Vector4d>(s).squaredNorm();
  }

  std::vector<PlaneSegment> segments_;
  PlanePhotometricCost photometric_;
  PlaneMomentCost moment_;
  double plane_[kPlaneSize] = {};
  std::vector<double> energies_;
};

struct Convergence {
  double remaining_1 = 0, remaining_3 = 0;
  int iterations = 0;
};

Convergence Measure(const std::vector<std::vector<double>>& energies,
                    const std::vector<double>& best) {
  Convergence result;
  for (size_t j = 0; j < energies.size(); ++j) {
    const auto share = [&](int i) {
      return (energies[j][i] - best[j]) / (energies[j][0] - best[j]);
    };
    result.remaining_1 += share(1) / static_cast<double>(energies.size());
    result.remaining_3 += share(3) / static_cast<double>(energies.size());
    int i = 0;
    while (i <= kMaxIterations && share(i) > 1e-4) ++i;
    if (i > kMaxIterations) i = -1;
    if (result.iterations >= 0) {
      result.iterations = i < 0 ? -1 : std::max(result.iterations, i);
    }
  }
  return result;
}

void MeasureAll(const BenchScene& bench, const std::vector<double>& distances) {
  const TextureProblem& problem = bench.scene.problem;
  const PhotoChannel channel =
      MakePhotoChannels(problem, bench.start, PointsAt::kMesh)[0];
  std::vector<std::unique_ptr<PlaneFit>> fits;
  std::vector<double> best;
  const auto start = [&](int j) {
    return bench.start.planes.data() + kPlaneSize * j;
  };
  for (int j = 0; j < problem.NumPlanes(); ++j) {
    fits.push_back(std::make_unique<PlaneFit>(bench, channel, j));
    const std::vector<double> e =
        fits.back()->Solve(PlaneKind::kAnchored, problem.anchors[j], start(j));
    best.push_back(*std::min_element(e.begin(), e.end()));
  }
  const std::pair<const char*, PlaneKind> kinds[] = {
      {"anchored", PlaneKind::kAnchored},
      {"raw4", PlaneKind::kRaw4},
      {"normalised4", PlaneKind::kNormalised4},
      {"origin", PlaneKind::kOrigin},
      {"unit4", PlaneKind::kUnit4}};
  for (const auto& [name, kind] : kinds) {
    for (const bool along : {true, false}) {
      for (const double distance : distances) {
        std::vector<std::vector<double>> energies;
        for (int j = 0; j < problem.NumPlanes(); ++j) {
          const Eigen::Vector3d& n = bench.scene.planes[j].normal;
          const Eigen::Vector3d direction = along ? n : n.unitOrthogonal();
          energies.push_back(
              fits[j]->Solve(kind, distance * direction, start(j)));
        }
        const Convergence c = Measure(energies, best);
        std::printf("%s,%s,%g,%.2g,%.2g,%d\n",
                    name,
                    along ? "normal" : "in-plane",
                    distance,
                    c.remaining_1,
                    c.remaining_3,
                    c.iterations);
      }
    }
  }
}

}  // namespace
}  // namespace facet

int main(int argc, char** argv) {
  using namespace facet;
  const BenchArgs args = StartBenchmark(argc, argv);
  std::printf("plane,origin,distance_m,remaining_1,remaining_3,iterations\n");
  BenchScene bench = MakeBenchScene({args.small ? 20000u : 300000u, 8});
  bench.start = bench.scene.truth;
  PerturbPlanes(0.03, 0.015, 3, &bench.start);
  bench.weights = StartFrom(&bench.start, &bench.scene.problem);
  MeasureAll(bench,
             args.small ? std::vector<double>{0, 10}
                        : std::vector<double>{0, 3, 30, 300});
}
