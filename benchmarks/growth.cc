// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// How CPU time and memory grow with the scan.
//
//   bench-growth observations   of E_c, on 60 keyframes
//   bench-growth keyframes      at 4 million observations
//   bench-growth MESH.ply ...   faces: the mesh stages on each
//   bench-growth plot FILE.csv  what one of these printed, as a log-log plot
//                               (SVG on stdout)
//   bench-growth small          a smoke test
//
// A line a measurement on stdout, and as comments the exponents b of
// time = a size^b, fitted to the logarithms over all sizes of a series.
#include <malloc.h>

#include <algorithm>
#include <cmath>
#include <exception>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "ablate/svg_plot.h"
#include "benchmarks/bench_args.h"
#include "benchmarks/bench_scene.h"
#include "mesh/clean.h"
#include "mesh/merge.h"
#include "mesh/mesh_io.h"
#include "mesh/partition.h"
#include "mesh/simplify.h"
#include "problems/solve_blocks.h"
#include "util/atomic_file.h"

namespace facet {
namespace {

struct Point {
  double size, cpu_s;
};

class GrowthTable {
 public:
  explicit GrowthTable(const char* axis) : axis_(axis) {}

  // Runs `work` once.
  template <typename Work>
  void Measure(double size, const char* what, const Work& work) {
    malloc_trim(0);
    ResetPeakRss();
    const Stopwatch watch;
    work();
    const double cpu_s = watch.CpuSecondsSince();
    std::printf("%s,%.0f,%s,%.2f,%.2f,%.0f\n",
                axis_,
                size,
                what,
                cpu_s,
                watch.WallSeconds(),
                PeakRssMb());
    std::fflush(stdout);
    series_[what].push_back({size, cpu_s});
  }

  void PrintExponents() const {
    for (const auto& [what, points] : series_) {
      if (points.size() < 2) continue;
      double n = 0, x = 0, y = 0, xx = 0, xy = 0;
      for (const Point& point : points) {
        const double a = std::log(point.size), b = std::log(point.cpu_s);
        n += 1, x += a, y += b, xx += a * a, xy += a * b;
      }
      std::printf("# %s: time ~ %s^%.2f\n",
                  what.c_str(),
                  axis_,
                  (n * xy - x * y) / (n * xx - x * x));
    }
  }

 private:
  const char* axis_;
  std::map<std::string, std::vector<Point>> series_;
};

void PrintHeader() { std::printf("axis,size,what,cpu_s,wall_s,peak_mb\n"); }

void MeasurePhases(double size,
                   const BenchSize& scene_size,
                   GrowthTable* table) {
  const BenchScene bench = MakeBenchScene(scene_size);
  const TextureProblem& problem = bench.scene.problem;
  SolverConfig config;
  config.trace_rms_grey = false;
  const EnergyTerms before =
      EvaluateEnergy(problem, bench.weights, bench.start);
  const auto solve = [&](unsigned blocks) {
    ReconState state = bench.start;
    SolverMemory memory;
    SolveBlocks(
        problem, bench.weights, blocks, config, before, &memory, &state);
  };
  table->Measure(size, "C", [&] { solve(kColors); });
  table->Measure(size, "Phi", [&] { solve(kPlanes); });
  table->Measure(size, "T+F", [&] { solve(kPoses | unsigned{kWarps}); });
  table->Measure(
      size, "C+Phi+T", [&] { solve(kColors | kPoses | unsigned{kPlanes}); });
}

void GrowObservations(const std::vector<size_t>& sizes) {
  PrintHeader();
  GrowthTable table("observations");
  for (const size_t n : sizes) {
    MeasurePhases(static_cast<double>(n), {n, 60, 320, 240}, &table);
  }
  table.PrintExponents();
}

void GrowKeyframes(const std::vector<int>& sizes, size_t observations) {
  PrintHeader();
  GrowthTable table("keyframes");
  for (const int n : sizes) {
    MeasurePhases(n, {observations, n, 320, 240}, &table);
  }
  table.PrintExponents();
}

void GrowFaces(const std::vector<std::string>& paths) {
  PrintHeader();
  GrowthTable table("faces");
  for (const std::string& path : paths) {
    TriMesh mesh = ReadMesh(path).mesh;
    CleanMesh({}, &mesh);
    SplitNonManifold(&mesh);
    const auto size = static_cast<double>(mesh.NumFaces());
    PlanarPartition planes;
    table.Measure(size, "partition", [&] { planes = PartitionMesh(mesh, {}); });
    table.Measure(
        size, "merge", [&] { planes = MergePlanes(mesh, planes, {}); });
    table.Measure(
        size, "simplify", [&] { SimplifyByPlanes(mesh, planes, {}); });
  }
  table.PrintExponents();
}

// A line an item of the column `what`, of CPU seconds over sizes.
void DrawGrowth(const std::string& path) {
  Plot plot;
  plot.y_label = "CPU time [s]";
  plot.x_from_zero = false;
  plot.log_y = true;
  std::istringstream csv(ReadFile(path));
  std::string row;
  while (std::getline(csv, row)) {
    char axis[40], what[40];
    double size = 0, cpu_s = 0;
    if (std::sscanf(row.c_str(),
                    "%39[^,],%lf,%39[^,],%lf",
                    axis,
                    &size,
                    what,
                    &cpu_s) != 4) {
      continue;  // header, exponents
    }
    plot.x_label = std::string("log10 of the number of ") + axis;
    auto line = std::find_if(
        plot.lines.begin(), plot.lines.end(), [&](const PlotLine& l) {
          return l.label == what;
        });
    if (line == plot.lines.end()) {
      PlotLine fresh;
      fresh.label = what;
      fresh.index = plot.lines.size();
      fresh.markers = true;
      line = plot.lines.insert(plot.lines.end(), fresh);
    }
    line->x.push_back(std::log10(size));
    line->y.push_back(cpu_s);
  }
  std::printf("%s", DrawSvg(plot).c_str());
}

// False if there is nothing to do.
bool Run(const std::vector<std::string>& args) {
  const std::string first = args.empty() ? "" : args[0];
  if (first == "small") {
    GrowKeyframes({4, 6}, 20000);
  } else if (first == "observations") {
    GrowObservations(
        {1000000, 3000000, 10000000, 30000000, 100000000, 300000000});
  } else if (first == "keyframes") {
    GrowKeyframes({50, 100, 200, 400, 900}, 4000000);
  } else if (first == "plot" && args.size() == 2) {
    DrawGrowth(args[1]);
  } else if (!args.empty()) {
    GrowFaces(args);
  }
  return !args.empty();
}

}  // namespace
}  // namespace facet

int main(int argc, char** argv) {
  google::InitGoogleLogging(argv[0]);
  FLAGS_minloglevel = google::ERROR;
  try {
    if (facet::Run({argv + 1, argv + argc})) return 0;
  } catch (const std::exception& e) {
    std::fprintf(stderr, "%s: error: %s\n", argv[0], e.what());
    return 1;
  }
  std::fprintf(stderr,
               "usage: %s observations | keyframes | plot FILE.csv | small | "
               "MESH.ply ...\n",
               argv[0]);
  return 2;
}
