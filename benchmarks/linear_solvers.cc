// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Ceres's linear solvers on the two systems of facet:
//
//   camera  pose and warp of a keyframe (6 + 640 unknowns), compressed blocks
//   joint   all poses and planes, rows as problems/joint_step.h hands them to
//           Ceres: 3 over the offset of a plane that follows the poses, 6 over
//           a pose and all later ones. The numbers in it are random: time
//           depends on the pattern only.
//   coupled the same with planes that do not follow: 3 rows over a plane and
//           the poses that see it
//
// linear_ms is the time of one linear solve (wall; the best of the repetitions
// of every problem by itself), cost the one reached.
#include <ceres/cost_function.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <array>
#include <memory>
#include <string>

#include "benchmarks/bench_args.h"
#include "benchmarks/camera_problem.h"
#include "util/random.h"

namespace facet {
namespace {

struct SolverChoice {
  const char* name;
  ceres::LinearSolverType type;
  ceres::SparseLinearAlgebraLibraryType sparse;
};
constexpr SolverChoice kChoices[] = {
    {"Cholesky (EigenSparse)",
     ceres::SPARSE_NORMAL_CHOLESKY,
     ceres::EIGEN_SPARSE},
    {"Cholesky (SuiteSparse)",
     ceres::SPARSE_NORMAL_CHOLESKY,
     ceres::SUITE_SPARSE},
    {"Cholesky (dense)", ceres::DENSE_NORMAL_CHOLESKY, ceres::EIGEN_SPARSE},
    {"Schur (EigenSparse)", ceres::SPARSE_SCHUR, ceres::EIGEN_SPARSE},
    {"Schur (SuiteSparse)", ceres::SPARSE_SCHUR, ceres::SUITE_SPARSE},
    {"Schur (dense)", ceres::DENSE_SCHUR, ceres::EIGEN_SPARSE},
    {"Schur (iterative)", ceres::ITERATIVE_SCHUR, ceres::EIGEN_SPARSE},
    {"CGNR", ceres::CGNR, ceres::EIGEN_SPARSE},
};

struct LinearTime {
  double seconds = 0;
  int solves = 0;
  double cost = 0;
};

LinearTime Solve(const SolverChoice& choice, ceres::Problem* problem) {
  ceres::Solver::Options options = CameraSolverOptions(4);
  options.linear_solver_type = choice.type;
  options.sparse_linear_algebra_library_type = choice.sparse;
  if (choice.type == ceres::CGNR) options.preconditioner_type = ceres::JACOBI;
  ceres::Solver::Summary summary;
  ceres::Solve(options, problem, &summary);
  LinearTime time;
  time.seconds = summary.linear_solver_time_in_seconds;
  time.solves = summary.num_linear_solves;
  time.cost = summary.final_cost;
  return time;
}

// `make` builds the same problem anew and solves it with `choice`.
template <typename SolveAnew>
LinearTime BestOf(int repetitions, const SolveAnew& solve_anew) {
  LinearTime best = solve_anew();
  for (int i = 1; i < repetitions; ++i) {
    best.seconds = std::min(best.seconds, solve_anew().seconds);
  }
  return best;
}

void Print(const char* system,
           const std::string& size,
           const char* solver,
           const LinearTime& time) {
  std::printf("%s,%s,%s,%.4g,%.8g\n",
              system,
              size.c_str(),
              solver,
              1e3 * time.seconds / std::max(time.solves, 1),
              time.cost);
  std::fflush(stdout);
}

void MeasureCameras(const BenchScene& bench, int repetitions) {
  for (const SolverChoice& choice : kChoices) {
    LinearTime sum;
    const int keyframes = bench.scene.problem.NumKeyframes();
    for (int k = 0; k < keyframes; ++k) {
      const LinearTime best = BestOf(repetitions, [&] {
        ReconState state = bench.start;
        const std::vector<PhotoChannel> channels =
            MakePhotoChannels(bench.scene.problem, state, PointsAt::kPlane);
        CameraProblem camera(bench, channels, CostForm::kCompressed, k, &state);
        return Solve(choice, camera.ceres_problem());
      });
      sum.seconds += best.seconds;
      sum.solves += best.solves;
      sum.cost += best.cost;
    }
    Print("camera",
          std::to_string(6 + 2 * bench.scene.problem.lattice.NumVertices()),
          choice.name,
          sum);
  }
}

// r = R (x - x0) + r0 over some blocks, R and r0 random.
class LinearRows : public ceres::CostFunction {
 public:
  LinearRows(int rows, const std::vector<int>& sizes, Random* random) {
    set_num_residuals(rows);
    for (const int size : sizes) {
      mutable_parameter_block_sizes()->push_back(size);
      std::vector<double> j;
      for (int i = 0; i < rows * size; ++i) j.push_back(random->Normal());
      jacobians_.push_back(std::move(j));
    }
    // Strong diagonal: the systems of real scenes are well conditioned too.
    for (int i = 0; i < rows; ++i) jacobians_[0][i * sizes[0] + i] += 20;
  }

  bool Evaluate(double const* const* parameters,
                double* residuals,
                double** jacobians) const override {
    const std::vector<int>& sizes = parameter_block_sizes();
    for (int i = 0; i < num_residuals(); ++i) {
      residuals[i] = 1;
      for (size_t b = 0; b < sizes.size(); ++b) {
        for (int k = 0; k < sizes[b]; ++k) {
          residuals[i] += jacobians_[b][i * sizes[b] + k] * parameters[b][k];
        }
      }
    }
    for (size_t b = 0; jacobians && b < sizes.size(); ++b) {
      if (!jacobians[b]) continue;
      std::copy(jacobians_[b].begin(), jacobians_[b].end(), jacobians[b]);
    }
    return true;
  }

 private:
  std::vector<std::vector<double>> jacobians_;
};

struct JointSize {
  int keyframes, planes, seen_by;  // keyframes that see a plane
};

// Tangent sizes as block sizes, so that no manifold is needed.
void MeasureJoint(const JointSize& size, bool coupled, int repetitions) {
  for (const SolverChoice& choice : kChoices) {
    const LinearTime best = BestOf(repetitions, [&] {
      Random random(5);
      std::vector<std::array<double, 6>> poses(size.keyframes);
      std::vector<std::array<double, 3>> planes(size.planes);
      for (auto& pose : poses) pose.fill(0.1);
      for (auto& plane : planes) plane.fill(0.1);
      ceres::Problem problem;
      for (int j = 0; j < size.planes; ++j) {
        std::vector<double*> blocks = {planes[j].data()};
        std::vector<int> sizes = {3};
        const int first =
            static_cast<int>(random.Index(size.keyframes - size.seen_by + 1));
        for (int k = first; coupled && k < first + size.seen_by; ++k) {
          blocks.push_back(poses[k].data());
          sizes.push_back(6);
        }
        problem.AddResidualBlock(
            new LinearRows(3, sizes, &random), nullptr, blocks);
      }
      for (int k = 0; k < size.keyframes; ++k) {
        std::vector<double*> blocks;
        for (int l = k; l < size.keyframes; ++l) {
          blocks.push_back(poses[l].data());
        }
        problem.AddResidualBlock(
            new LinearRows(6, std::vector<int>(blocks.size(), 6), &random),
            nullptr,
            blocks);
      }
      return Solve(choice, &problem);
    });
    Print(coupled ? "coupled" : "joint",
          std::to_string(6 * size.keyframes + 3 * size.planes),
          choice.name,
          best);
  }
}

}  // namespace
}  // namespace facet

int main(int argc, char** argv) {
  using namespace facet;
  const BenchArgs args = StartBenchmark(argc, argv);
  std::printf("system,unknowns,solver,linear_ms,cost\n");
  MeasureCameras(
      args.small ? MakeBenchScene({10000, 2}) : MakeBenchScene({400000, 4}),
      args.repetitions);
  for (const bool coupled : {false, true}) {
    if (args.small) {
      MeasureJoint({4, 3, 2}, coupled, 1);
      continue;
    }
    MeasureJoint({30, 40, 15}, coupled, args.repetitions);
    MeasureJoint({100, 150, 30}, coupled, args.repetitions);
  }
}
