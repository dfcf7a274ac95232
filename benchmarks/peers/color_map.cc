// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// bench-peer-color-map: Open3D's colour map optimisation of a dense mesh.
//   rigid MESH ITERATIONS OUTPUT SEQUENCE       poses; 0 iterations: the mean
//                                               colour at the input poses
//   non-rigid MESH ITERATIONS OUTPUT SEQUENCE   poses and image warps
// It sees facet's keyframes without the held-out frames. It knows one camera
// only, so colours are looked up from the depth images, as in facet-fuse.
#include <omp.h>
#include <open3d/pipelines/color_map/NonRigidOptimizer.h>
#include <open3d/pipelines/color_map/RigidOptimizer.h>
#include <open3d/utility/Logging.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>

#include "benchmarks/peers/held_out.h"
#include "benchmarks/peers/open3d_mesh.h"
#include "benchmarks/peers/peer_run.h"
#include "mesh/mesh_io.h"
#include "rgbd/depth.h"
#include "rgbd/keyframes.h"

namespace facet {
namespace {

namespace o3d = open3d;

// Dense meshes of a depth camera reach farther than Open3D's default, 2.5 m.
constexpr double kMaxDepthM = 4;

struct Scan {
  std::vector<o3d::geometry::RGBDImage> images;
  o3d::camera::PinholeCameraTrajectory cameras;
};

o3d::geometry::Image ToOpen3d(const cv::Mat& image, int channels, int bytes) {
  o3d::geometry::Image result;
  result.Prepare(image.cols, image.rows, channels, bytes);
  const size_t row_bytes = static_cast<size_t>(image.cols) * channels * bytes;
  for (int y = 0; y < image.rows; ++y) {
    std::memcpy(result.data_.data() + y * row_bytes, image.ptr(y), row_bytes);
  }
  return result;
}

Scan LoadScan(const std::string& path) {
  const std::unique_ptr<RgbdSequence> sequence = OpenSequence(path, {});
  const Pinhole& camera = sequence->calibration().depth;
  Scan scan;
  for (const int frame : SelectKeyframes(*sequence, PeerKeyframes())) {
    cv::Mat depth = sequence->LoadDepth(frame);
    const RegisteredColor registered = RegisterColorToDepth(
        sequence->LoadColor(frame), depth, sequence->calibration());
    depth.setTo(0, registered.seen == 0);
    scan.images.emplace_back(ToOpen3d(registered.color, 3, 1),
                             ToOpen3d(depth, 1, 4));
    o3d::camera::PinholeCameraParameters parameters;
    parameters.intrinsic_ = {camera.width,
                             camera.height,
                             camera.fx,
                             camera.fy,
                             camera.cx,
                             camera.cy};
    parameters.extrinsic_ =
        sequence->frames()[frame].depth_cam_from_world.Matrix();
    scan.cameras.parameters_.push_back(parameters);
  }
  return scan;
}

o3d::geometry::TriangleMesh Optimize(const PeerArgs& args,
                                     const o3d::geometry::TriangleMesh& mesh,
                                     const Scan& scan) {
  namespace color_map = o3d::pipelines::color_map;
  if (args.method == "rigid") {
    color_map::RigidOptimizerOption options;
    options.maximum_iteration_ = args.count;
    options.maximum_allowable_depth_ = kMaxDepthM;
    return color_map::RunRigidOptimizer(
               mesh, scan.images, scan.cameras, options)
        .first;
  }
  color_map::NonRigidOptimizerOption options;
  options.maximum_iteration_ = args.count;
  options.maximum_allowable_depth_ = kMaxDepthM;
  return color_map::RunNonRigidOptimizer(
             mesh, scan.images, scan.cameras, options)
      .first;
}

void Run(const PeerArgs& args) {
  omp_set_num_threads(1);
  o3d::utility::SetVerbosityLevel(o3d::utility::VerbosityLevel::Error);
  TriMesh mesh = ReadPeerMesh(args.input);
  const Scan scan = LoadScan(args.sequence);
  const o3d::geometry::TriangleMesh peer = ToOpen3d(mesh);
  mesh.vertex_colors.clear();

  const StageMeter meter;
  const o3d::geometry::TriangleMesh colored = Optimize(args, peer, scan);
  meter.Print(args.method, mesh.NumFaces());

  for (const Eigen::Vector3d& color : colored.vertex_colors_) {
    Rgb rgb;
    for (int i = 0; i < 3; ++i) {
      rgb[i] = static_cast<uint8_t>(
          std::lround(255 * std::clamp(color[i], 0.0, 1.0)));
    }
    mesh.vertex_colors.push_back(rgb);
  }
  WritePly(args.output, mesh);
}

}  // namespace
}  // namespace facet

int main(int argc, char** argv) {
  return facet::RunPeer(argc, argv, {{"rigid", "non-rigid"}, true}, facet::Run);
}
