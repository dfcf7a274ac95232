// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// facet-fuse: a dense, coloured mesh from a scan, by volumetric fusion of the
// depth images (Open3D's ScalableTSDFVolume). Geometry comes from the depth
// camera; every depth pixel takes its colour from the colour camera through the
// calibration of both, and pixels that the colour camera does not see are left
// out.
#include <gflags/gflags.h>
#include <omp.h>
#include <open3d/camera/PinholeCameraIntrinsic.h>
#include <open3d/geometry/Image.h>
#include <open3d/geometry/RGBDImage.h>
#include <open3d/geometry/TriangleMesh.h>
#include <open3d/pipelines/integration/ScalableTSDFVolume.h>
#include <open3d/utility/Logging.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <map>
#include <memory>
#include <vector>

#include "apps/flags/holdout.h"
#include "apps/flags/sequence.h"
#include "apps/init_app.h"
#include "mesh/mesh_io.h"
#include "rgbd/depth.h"
#include "rgbd/keyframes.h"
#include "rgbd/trajectory_io.h"
#include "util/errors.h"
#include "util/parallel_for.h"
#include "util/progress.h"
#include "util/resources.h"
#include "util/warnings.h"

DEFINE_string(output, "", "the mesh to write, .ply");
DEFINE_double(voxel_size, 0.01, "edge of a voxel [m]");
DEFINE_double(sdf_truncation,
              0,
              "distance from the surface within which depth is integrated [m]; "
              "0 = 4 voxels");
DEFINE_int32(frame_step, 1, "only frame numbers divisible by this are fused");
DEFINE_double(fuse_max_depth, 4.0, "farther depth is not fused [m]");
DEFINE_string(
    poses,
    "",
    "optional poses.txt whose poses replace those of the scan; frames "
    "that are not in it are left out");
DEFINE_int32(threads, 0, "number of threads; 0 = one per core");

namespace facet {
namespace {

// Frames decoded and registered side by side before they are integrated one
// after the other.
constexpr size_t kBatch = 16;
// More undecodable frames than this and the scan is damaged as a whole.
constexpr double kMaxUnreadableShare = 0.2;

namespace o3d = open3d;
using Volume = o3d::pipelines::integration::ScalableTSDFVolume;

struct FuseFrame {
  int frame_idx = 0;
  Pose depth_cam_from_world;
};

// A decoded frame: depth of the pixels with colour, and that colour.
struct RegisteredFrame {
  o3d::geometry::RGBDImage image;
  size_t with_depth = 0, with_color = 0;
  std::string problem;  // not empty: it does not decode
};

void CheckFlags() {
  if (FLAGS_output.empty()) {
    throw OptionsError("--output is missing: give the .ply to write");
  }
  if (!(FLAGS_voxel_size > 0)) {
    throw OptionsError("--voxel_size must be positive");
  }
  if (FLAGS_sdf_truncation != 0 &&
      !(FLAGS_sdf_truncation >= FLAGS_voxel_size)) {
    throw OptionsError("--sdf_truncation must be at least one --voxel_size");
  }
  if (FLAGS_frame_step < 1) {
    throw OptionsError("--frame_step must be at least 1");
  }
  if (FLAGS_threads < 0) throw OptionsError("--threads must not be negative");
}

std::vector<FuseFrame> ChooseFrames(const RgbdSequence& sequence) {
  KeyframeOptions holdout;
  HoldoutFromFlags(&holdout);
  std::map<int, Pose> replaced;
  if (!FLAGS_poses.empty()) {
    for (const NumberedPose& pose : ReadPoses(FLAGS_poses)) {
      replaced[pose.number] = pose.world_from_cam;
    }
  }
  const Pose depth_from_color =
      sequence.calibration().color_from_depth.Inverse();
  std::vector<FuseFrame> chosen;
  for (size_t i = 0; i < sequence.frames().size(); ++i) {
    const Frame& frame = sequence.frames()[i];
    if (!frame.usable || frame.number % FLAGS_frame_step != 0 ||
        IsHeldOut(frame.number, holdout)) {
      continue;
    }
    Pose pose = frame.depth_cam_from_world;
    if (!FLAGS_poses.empty()) {
      const auto it = replaced.find(frame.number);
      if (it == replaced.end()) continue;
      pose = depth_from_color * sequence.ColorCamFromPoseFile(it->second);
    }
    chosen.push_back({static_cast<int>(i), pose});
  }
  if (chosen.empty()) {
    throw UnsolvableError("no frame of '" + sequence.path() +
                          "' is left to fuse: lower --frame_step, or check "
                          "--holdout_stride and --poses");
  }
  return chosen;
}

o3d::geometry::Image ToOpen3d(const cv::Mat& image, int channels, int bytes) {
  o3d::geometry::Image result;
  result.Prepare(image.cols, image.rows, channels, bytes);
  const size_t row_bytes = static_cast<size_t>(image.cols) * channels * bytes;
  for (int y = 0; y < image.rows; ++y) {
    std::memcpy(result.data_.data() + y * row_bytes, image.ptr(y), row_bytes);
  }
  return result;
}

RegisteredFrame LoadFrame(const RgbdSequence& sequence, int frame_idx) {
  RegisteredFrame frame;
  try {
    cv::Mat depth = sequence.LoadDepth(frame_idx);
    const RegisteredColor registered = RegisterColorToDepth(
        sequence.LoadColor(frame_idx), depth, sequence.calibration());
    frame.with_depth = cv::countNonZero(depth);
    frame.with_color = cv::countNonZero(registered.seen);
    depth.setTo(0, registered.seen == 0);
    frame.image = {ToOpen3d(registered.color, 3, 1), ToOpen3d(depth, 1, 4)};
  } catch (const InputError& e) {
    frame.problem = e.what();
  }
  return frame;
}

// Integrates all frames in order.
void Integrate(const RgbdSequence& sequence,
               const std::vector<FuseFrame>& frames,
               Volume* volume) {
  const Pinhole& camera = sequence.calibration().depth;
  const o3d::camera::PinholeCameraIntrinsic intrinsic(
      camera.width, camera.height, camera.fx, camera.fy, camera.cx, camera.cy);
  size_t with_depth = 0, with_color = 0, unreadable = 0;
  std::string first_problem;
  Progress progress("fusing", frames.size());
  for (size_t begin = 0; begin < frames.size(); begin += kBatch) {
    const size_t count = std::min(kBatch, frames.size() - begin);
    std::vector<RegisteredFrame> batch(count);
    ParallelFor(0, count, [&](size_t i) {
      batch[i] = LoadFrame(sequence, frames[begin + i].frame_idx);
    });
    for (size_t i = 0; i < count; ++i) {
      progress.Add();
      if (!batch[i].problem.empty()) {
        if (unreadable++ == 0) first_problem = batch[i].problem;
        continue;
      }
      with_depth += batch[i].with_depth;
      with_color += batch[i].with_color;
      volume->Integrate(batch[i].image,
                        intrinsic,
                        frames[begin + i].depth_cam_from_world.Matrix());
    }
  }
  if (unreadable > 0) {
    const std::string sentence =
        std::to_string(unreadable) + " of " + std::to_string(frames.size()) +
        " frames cannot be read, the first: " + first_problem;
    if (unreadable > kMaxUnreadableShare * frames.size()) {
      throw InputError(sentence);
    }
    AddWarning(sentence + ": skipped");
  }
  if (with_color == 0) {
    throw UnsolvableError(
        "no depth pixel of '" + sequence.path() +
        "' lies within the depth range and is seen by the colour camera: "
        "check m_depthShift and the extrinsics with facet-check-input");
  }
  std::printf(
      "fuse       %zu frames, %.1f %% of the depth pixels seen by the "
      "colour camera\n",
      frames.size() - unreadable,
      100.0 * static_cast<double>(with_color) /
          static_cast<double>(with_depth));
}

TriMesh ExtractMesh(Volume* volume) {
  const auto extracted = volume->ExtractTriangleMesh();
  TriMesh mesh;
  mesh.vertices.assign(extracted->vertices_.begin(),
                       extracted->vertices_.end());
  mesh.faces.reserve(extracted->triangles_.size());
  for (const Eigen::Vector3i& f : extracted->triangles_) {
    mesh.faces.push_back({f[0], f[1], f[2]});
  }
  mesh.vertex_colors.reserve(extracted->vertex_colors_.size());
  for (const Eigen::Vector3d& color : extracted->vertex_colors_) {
    Rgb rgb;
    for (int i = 0; i < 3; ++i) {
      rgb[i] = static_cast<uint8_t>(
          std::lround(255 * std::clamp(color[i], 0.0, 1.0)));
    }
    mesh.vertex_colors.push_back(rgb);
  }
  if (mesh.faces.empty()) {
    throw UnsolvableError(
        "fusion gave no surface: check the depth unit and the pose direction "
        "with facet-check-input, or use a larger --voxel_size");
  }
  return mesh;
}

// Open3D's threads meet after every block of 16^3 voxels: on cores that others
// use, too, that is 20 times slower than one thread. It asks OpenMP for the
// number of threads only if the variable is set.
void UseOneOpen3dThread() {
  setenv("OMP_NUM_THREADS", "1", 1);
  omp_set_num_threads(1);
}

int Run() {
  CheckFlags();
  SetNumThreads(FLAGS_threads);
  o3d::utility::SetVerbosityLevel(o3d::utility::VerbosityLevel::Error);
  UseOneOpen3dThread();
  const Stopwatch watch;
  SequenceOptions options = SequenceOptionsFromFlags();
  options.max_depth_m = std::min(options.max_depth_m, FLAGS_fuse_max_depth);
  const auto sequence = OpenSequenceFromFlags(options);
  const std::vector<FuseFrame> frames = ChooseFrames(*sequence);
  const double truncation =
      FLAGS_sdf_truncation > 0 ? FLAGS_sdf_truncation : 4 * FLAGS_voxel_size;
  std::printf(
      "open       %zu of %zu frames chosen, voxel %g m, truncation %g m"
      "\n",
      frames.size(),
      sequence->frames().size(),
      FLAGS_voxel_size,
      truncation);
  Volume volume(FLAGS_voxel_size,
                truncation,
                o3d::pipelines::integration::TSDFVolumeColorType::RGB8);
  Integrate(*sequence, frames, &volume);
  const TriMesh mesh = ExtractMesh(&volume);
  std::printf("extract    %zu vertices, %zu faces\n",
              mesh.NumVertices(),
              mesh.NumFaces());
  WritePly(FLAGS_output, mesh);
  std::printf("write      %s, %.1f s in all, peak %.0f MB\n",
              FLAGS_output.c_str(),
              watch.WallSeconds(),
              PeakRssMb());
  return kExitOk;
}

}  // namespace
}  // namespace facet

int main(int argc, char** argv) {
  return facet::RunApp(
      argc,
      argv,
      {"Fuses the depth and colour images of a scan into a dense mesh.\n"
       "  facet-fuse --sequence=DIR --output=dense.ply [--voxel_size=0.01] "
       "[--frame_step=5]",
       {}},
      facet::Run);
}
