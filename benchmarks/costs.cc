// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// One evaluation of E_c over all observations, per residual, for every form,
// sampling and instruction set:
//
//   form/sampling/channels/kernel/what    what = r or rJ (with Jacobian)
//
// and for the kernels, bilinear, with a loss or `drop` in place of the
// sampling.
//
// The compressed forms end in the rows that Ceres gets. The forms with a cost
// function an observation see the first keyframes only: their time a residual
// does not depend on how many there are, their memory does.
#include <benchmark/benchmark.h>

#include <deque>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "benchmarks/bench_args.h"
#include "benchmarks/bench_scene.h"
#include "benchmarks/observation_costs.h"
#include "costs/compressed_block.h"
#include "costs/frame_cell_cost.h"
#include "costs/photometric.h"
#include "costs/plane_manifold.h"
#include "problems/cell_bins.h"

namespace facet {
namespace {

// A scene with its observations binned, for one formulation at a time.
struct Work {
  BenchScene bench;
  std::vector<PhotoChannel> channels;
  std::vector<CellBins> bins;  // a keyframe

  const TextureProblem& problem() const { return bench.scene.problem; }
  int NumColumns() const { return problem().lattice.columns - 1; }

  void Prepare(const Formulation& formulation) {
    const Formulation& now = problem().formulation;
    if (!bins.empty() && now.sampling == formulation.sampling &&
        now.channels == formulation.channels && now.loss == formulation.loss &&
        now.out_of_image == formulation.out_of_image) {
      return;
    }
    SetFormulation(formulation, &bench);
    channels = MakePhotoChannels(problem(), bench.start, PointsAt::kPlane);
    bins.clear();
    for (int k = 0; k < problem().NumKeyframes(); ++k) {
      bins.push_back(BinByCell(problem(),
                               channels[0].points,
                               bench.start.CamFromWorld(k),
                               k,
                               false));
    }
  }

  size_t NumResiduals() const {
    return problem().observations.size() * channels.size();
  }
};

// visit(channel, keyframe, a, b, ids, n) for every warp cell that is seen.
template <typename Visit>
void ForEachCell(const Work& work, const Visit& visit) {
  for (size_t channel = 0; channel < work.channels.size(); ++channel) {
    for (size_t k = 0; k < work.bins.size(); ++k) {
      const CellBins& bins = work.bins[k];
      for (size_t c = 0; c + 1 < bins.begin.size(); ++c) {
        const size_t n = bins.begin[c + 1] - bins.begin[c];
        if (n == 0) continue;
        visit(channel,
              k,
              static_cast<int>(c) % work.NumColumns(),
              static_cast<int>(c) / work.NumColumns(),
              bins.ids.data() + bins.begin[c],
              n);
      }
    }
  }
}

// FrameCellCost with a kernel of choice.
double EvaluateCells(const Work& work,
                     const PhotoKernel& kernel,
                     bool jacobians) {
  const float vertices[8] = {};
  PhotoCounts counts;
  double sum = 0;
  ForEachCell(work,
              [&](size_t channel,
                  size_t k,
                  int a,
                  int b,
                  const uint32_t* ids,
                  size_t n) {
                PhotoFrame frame = work.channels[channel].frames[k];
                frame.warp = vertices;
                double gram[GramSize(14)] = {};
                sum += kernel.frame_cell(frame,
                                         static_cast<float>(a),
                                         static_cast<float>(b),
                                         work.channels[channel].points.data(),
                                         ids,
                                         n,
                                         true,
                                         jacobians ? gram : nullptr,
                                         &counts);
                if (!jacobians) return;
                double rows[15 * 14], residuals[15];
                CompressGram(14, gram, rows, residuals);
                benchmark::DoNotOptimize(residuals[14]);
              });
  return sum;
}

// Cost functions as Ceres evaluates them, one after the other.
struct Functions {
  std::vector<std::unique_ptr<ceres::CostFunction>> functions;
  std::vector<size_t> keyframe;
  std::deque<CellView> views;  // stable addresses
  size_t residuals = 0;
};

double EvaluateFunctions(const Work& work, const Functions& f, bool jacobians) {
  size_t most = 0;
  for (const auto& function : f.functions) {
    most = std::max<size_t>(most, function->num_residuals());
  }
  std::vector<double> residuals(most), pose_rows(kPoseSize * most);
  std::vector<double> vertex_rows[4];
  double* rows[5] = {pose_rows.data()};
  for (int i = 0; i < 4; ++i) {
    vertex_rows[i].resize(2 * most);
    rows[1 + i] = vertex_rows[i].data();
  }
  const double zero[2] = {0, 0};
  double sum = 0;
  for (size_t i = 0; i < f.functions.size(); ++i) {
    const double* parameters[5] = {
        work.bench.start.poses.data() + kPoseSize * f.keyframe[i],
        zero,
        zero,
        zero,
        zero};
    f.functions[i]->Evaluate(
        parameters, residuals.data(), jacobians ? rows : nullptr);
    for (int r = 0; r < f.functions[i]->num_residuals(); ++r) {
      sum += residuals[r] * residuals[r];
    }
  }
  return sum;
}

// The observations `ids` of a warp cell as cost functions of the `form`.
void AddCell(const Work& work,
             const std::string& form,
             size_t channel,
             size_t k,
             int a,
             int b,
             const uint32_t* ids,
             size_t n,
             Functions* f) {
  const TextureProblem& problem = work.problem();
  const PhotoChannel& photo = work.channels[channel];
  const auto add = [&](ceres::CostFunction* function) {
    f->functions.emplace_back(function);
    f->keyframe.push_back(k);
  };
  f->residuals += n;
  if (form == "ceres") {
    add(new FrameCellCost(photo.frames[k],
                          problem.origin,
                          a,
                          b,
                          photo.points.data(),
                          ids,
                          n,
                          true,
                          1.0));
    return;
  }
  f->views.push_back(
      {SampledImageOf(problem, static_cast<int>(channel), static_cast<int>(k)),
       problem.camera,
       problem.lattice,
       a,
       b});
  const CellView& view = f->views.back();
  std::vector<ObservedPoint> points;
  for (size_t i = 0; i < n; ++i) {
    const PhotoTexel& t = photo.points[ids[i]];
    points.push_back(
        {Eigen::Vector3d(t.x, t.y, t.z) + problem.origin, t.color});
  }
  if (form == "batched") {
    add(new BatchedCost(view, std::move(points)));
    return;
  }
  for (size_t i = 0; i < n; ++i) {
    if (form == "analytic") {
      add(new AnalyticCost(view, points[i]));
      continue;
    }
    const int plane = problem.texels.plane[ids[i]];
    const PhotometricCost cost(view.image,
                               problem.camera,
                               problem.lattice,
                               a,
                               b,
                               problem.texels.position[ids[i]].cast<double>(),
                               problem.anchors[plane]);
    const PhotometricFrameCost frame_cost(
        cost,
        work.bench.start.planes.data() + kPlaneSize * plane,
        points[i].color);
    add(PhotometricFrameCost::Create(frame_cost, true));
  }
}

Functions MakeFunctions(const Work& work,
                        const std::string& form,
                        size_t max_keyframes) {
  Functions f;
  ForEachCell(work,
              [&](size_t channel,
                  size_t k,
                  int a,
                  int b,
                  const uint32_t* ids,
                  size_t n) {
                if (k >= max_keyframes) return;
                AddCell(work, form, channel, k, a, b, ids, n, &f);
              });
  return f;
}

// Everything but the timing loop happens outside of it; `sum` of the squared
// residuals, per residual, shows that all forms evaluate the same thing.
template <typename Evaluate>
void Run(benchmark::State& state, size_t residuals, const Evaluate& evaluate) {
  double sum = 0;
  for (auto _ : state) sum = evaluate();
  state.SetItemsProcessed(static_cast<int64_t>(residuals * state.iterations()));
  state.counters["mean_square"] = sum / static_cast<double>(residuals);
}

class Registry {
 public:
  Registry(Work* work, int repetitions)
      : work_(work), repetitions_(repetitions) {}

  // The production kernel with every instruction set of this processor.
  void AddKernels(const std::string& name, const Formulation& formulation) {
    for (const char* kernel_name : kPhotoKernelNames) {
      const PhotoKernel* kernel = FindPhotoKernel(kernel_name);
      if (!kernel) continue;
      for (const bool jacobians : {false, true}) {
        Add("kernel/" + name + "/" + kernel_name + End(jacobians),
            repetitions_,
            formulation,
            [work = work_, kernel, jacobians](benchmark::State& state) {
              Run(state, work->NumResiduals(), [&] {
                return EvaluateCells(*work, *kernel, jacobians);
              });
            });
      }
    }
  }

  // Cost functions as Ceres sees them.
  void AddFunctions(const std::string& name, const Formulation& formulation) {
    for (const char* form : {"ceres", "batched", "analytic", "autodiff"}) {
      const bool all = std::string(form) == "ceres";
      const std::string type = all ? GetPhotoKernel().name : "double";
      for (const bool jacobians : {false, true}) {
        Add(std::string(form) + "/" + name + "/" + type + End(jacobians),
            all ? repetitions_ : (repetitions_ + 1) / 2,
            formulation,
            [work = work_, form, all, jacobians](benchmark::State& state) {
              const Functions f =
                  MakeFunctions(*work, form, all ? work->bins.size() : 1);
              Run(state, f.residuals, [&] {
                return EvaluateFunctions(*work, f, jacobians);
              });
            });
      }
    }
  }

 private:
  static const char* End(bool jacobians) { return jacobians ? "/rJ" : "/r"; }

  // Benchmarks run in the order of their registration: the first of a
  // formulation prepares the scene.
  template <typename Body>
  void Add(const std::string& name,
           int repetitions,
           const Formulation& formulation,
           const Body& body) {
    benchmark::RegisterBenchmark(
        name.c_str(),
        [work = work_, formulation, body](benchmark::State& state) {
          work->Prepare(formulation);
          body(state);
        })
        ->Repetitions(repetitions)
        ->Iterations(1)
        ->Unit(benchmark::kMillisecond);
  }

  Work* work_;
  int repetitions_;
};

void RegisterAll(Registry* registry) {
  const std::pair<const char*, Sampling> samplings[] = {
      {"bilinear", Sampling::kBilinear},
      {"scharr", Sampling::kScharr},
      {"bicubic", Sampling::kBicubic}};
  for (const auto channels : {Channels::kLuma, Channels::kRgb}) {
    for (const auto& [name, sampling] : samplings) {
      Formulation formulation;
      formulation.sampling = sampling;
      formulation.channels = channels;
      const std::string full =
          std::string(name) + (channels == Channels::kLuma ? "/luma" : "/rgb");
      registry->AddKernels(full, formulation);
      registry->AddFunctions(full, formulation);
    }
  }
  const std::pair<const char*, LossKind> losses[] = {
      {"huber", LossKind::kHuber},
      {"cauchy", LossKind::kCauchy},
      {"tukey", LossKind::kTukey}};
  for (const auto& [name, loss] : losses) {
    Formulation formulation;
    formulation.loss = loss;
    registry->AddKernels(std::string(name) + "/luma", formulation);
  }
  Formulation formulation;
  formulation.out_of_image = OutOfImage::kDrop;
  registry->AddKernels("drop/luma", formulation);
}

}  // namespace
}  // namespace facet

int main(int argc, char** argv) {
  using namespace facet;
  benchmark::Initialize(&argc, argv);
  const BenchArgs args = StartBenchmark(argc, argv);
  Work work;
  work.bench =
      args.small ? MakeBenchScene({20000, 4}) : MakeBenchScene({10000000, 12});
  Registry registry(&work, args.repetitions);
  RegisterAll(&registry);
  benchmark::RunSpecifiedBenchmarks();
}
