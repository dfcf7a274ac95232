// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// bench-peers-evaluate: the quality of what the programs of the comparison
// wrote, as CSV, a line a file.
//   bench-peers-evaluate mesh INPUT.ply
//   bench-peers-evaluate simplification INPUT.ply MODEL.ply ...
//   bench-peers-evaluate partition LABELS.ply ...
//   bench-peers-evaluate color SEQUENCE MODEL ...    by the held-out photos
// and `bench-peers-evaluate stages RUN`, time and memory of facet-reconstruct.
#include <glog/logging.h>

#include <cstdio>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "benchmarks/peers/held_out.h"
#include "benchmarks/peers/peer_quality.h"
#include "benchmarks/peers/peer_run.h"
#include "eval/model_evaluation.h"
#include "mesh/mesh_io.h"
#include "texture/model_io.h"
#include "util/errors.h"

namespace facet {
namespace {

void DescribeMesh(const std::string& path) {
  const TriMesh mesh = ReadPeerMesh(path);
  double area = 0;
  for (size_t f = 0; f < mesh.NumFaces(); ++f) area += mesh.FaceArea(f);
  std::printf("faces,area_m2\n%zu,%.1f\n", mesh.NumFaces(), area);
}

void EvaluateSimplifications(const std::string& input,
                             const std::vector<std::string>& models) {
  const TriMesh dense = ReadPeerMesh(input);
  std::printf(
      "faces,accuracy_mean_mm,accuracy_rms_mm,completeness_mean_mm,"
      "completeness_rms_mm,non_manifold_edges,duplicate_faces,"
      "flipped_percent\n");
  for (const std::string& path : models) {
    const TriMesh model = ReadMesh(path).mesh;
    const SimplificationQuality quality =
        MeasureSimplification(model, dense, {});
    const DistanceStats& accuracy = quality.distance.accuracy;
    const DistanceStats& completeness = quality.distance.completeness;
    std::printf("%zu,%.2f,%.2f,%.2f,%.2f,%d,%d,%.2f\n",
                model.NumFaces(),
                1e3 * accuracy.mean,
                1e3 * accuracy.rms,
                1e3 * completeness.mean,
                1e3 * completeness.rms,
                quality.checks.non_manifold_edges,
                quality.checks.duplicate_faces,
                100 * quality.flipped_share);
  }
}

void EvaluatePartitions(const std::vector<std::string>& files) {
  std::printf("clusters,unlabelled_percent,rms_mm\n");
  for (const std::string& path : files) {
    const MeshFile file = ReadMesh(path);
    if (file.face_plane.empty()) {
      throw InputError(path + " has no plane_id for each face");
    }
    const PartitionQuality quality =
        MeasurePartition(file.mesh, file.face_plane);
    std::printf("%zu,%.1f,%.2f\n",
                quality.clusters,
                100 * quality.unlabelled_share,
                1e3 * quality.rms_m);
  }
}

// Held-out frames at the poses of the scan; alignment takes them from there.
std::vector<EvaluationFrame> HeldOutFrames(const RgbdSequence& sequence) {
  std::vector<EvaluationFrame> frames;
  for (size_t i = 0; i < sequence.frames().size(); ++i) {
    const Frame& frame = sequence.frames()[i];
    if (!frame.usable || !IsHeldOut(frame.number, PeerKeyframes())) continue;
    const int index = static_cast<int>(i);
    frames.push_back(
        {index, frame.number, sequence.color_cam_from_world(index)});
  }
  return frames;
}

void EvaluateColors(const std::string& scan,
                    const std::vector<std::string>& models) {
  const std::unique_ptr<RgbdSequence> sequence = OpenSequence(scan, {});
  const std::vector<EvaluationFrame> frames = HeldOutFrames(*sequence);
  std::printf("faces,psnr_aligned,gradient_ncc,gradient_energy,coverage\n");
  for (const std::string& path : models) {
    const TexturedMesh model = LoadModel(path);
    const ViewMetrics metrics =
        EvaluateModel(model, *sequence, frames, {}).aligned;
    std::printf("%zu,%.2f,%.3f,%.3f,%.3f\n",
                model.mesh.NumFaces(),
                metrics.psnr_affine,
                metrics.gradient_ncc,
                metrics.gradient_energy,
                metrics.coverage);
  }
}

// As the programs of the comparison print it; user_s includes the system's.
void PrintStages(const std::string& run) {
  std::ifstream file(run + "/report.json");
  const auto report = nlohmann::json::parse(file, nullptr, false);
  if (!report.is_object()) throw InputError(run + " has no report.json");
  std::printf("stage,user_s,wall_s,peak_mb,count\n");
  for (const auto& stage : report.at("stages")) {
    std::printf("%s,%.3f,%.3f,%.1f,0\n",
                stage.at("name").get<std::string>().c_str(),
                stage.at("cpu_s").get<double>(),
                stage.at("wall_s").get<double>(),
                stage.at("peak_rss_mb").get<double>());
  }
}

void Evaluate(const std::vector<std::string>& args) {
  const std::string what = args.empty() ? "" : args[0];
  if (what == "mesh" && args.size() == 2) {
    DescribeMesh(args[1]);
  } else if (what == "simplification" && args.size() > 2) {
    EvaluateSimplifications(args[1], {args.begin() + 2, args.end()});
  } else if (what == "partition" && args.size() > 1) {
    EvaluatePartitions({args.begin() + 1, args.end()});
  } else if (what == "color" && args.size() > 2) {
    EvaluateColors(args[1], {args.begin() + 2, args.end()});
  } else if (what == "stages" && args.size() == 2) {
    PrintStages(args[1]);
  } else {
    throw OptionsError(
        "usage: mesh INPUT, simplification INPUT MODEL ..., partition LABELS "
        "..., color SEQUENCE MODEL ... or stages RUN");
  }
}

}  // namespace
}  // namespace facet

int main(int argc, char** argv) {
  google::InitGoogleLogging(argv[0]);
  FLAGS_minloglevel = google::ERROR;
  return facet::ExitCodeOf(argv[0], [&] {
    facet::Evaluate({argv + 1, argv + argc});
  });
}
