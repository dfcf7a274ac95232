// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "synth/synth_scan.h"

#include <algorithm>
#include <cmath>

#include "synth/camera_path.h"
#include "synth/wander.h"
#include "util/errors.h"
#include "util/parallel_for.h"

namespace facet {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

void CheckOptions(const SynthOptions& o) {
  if (o.num_frames < 1 || o.num_frames > 100000) {
    throw OptionsError("frames must be between 1 and 100000");
  }
  if (o.width < 16 || o.height < 16 || o.width > 8192 || o.height > 8192) {
    throw OptionsError("width and height must be between 16 and 8192 pixels");
  }
  if (o.supersampling < 1 || o.supersampling > 8) {
    throw OptionsError("supersampling must be between 1 and 8");
  }
  if (!(o.pose_noise_mm >= 0) || !(o.pose_noise_deg >= 0) ||
      !(o.color_noise_grey >= 0)) {
    throw OptionsError("noise must not be negative");
  }
}

// An intrinsic matrix of a 640 x 480 image for another size.
Pinhole Scaled(
    double fx, double fy, double cx, double cy, const SynthOptions& o) {
  const double sx = o.width / 640.0, sy = o.height / 480.0;
  return {fx * sx,
          fy * sy,
          (cx + 0.5) * sx - 0.5,
          (cy + 0.5) * sy - 0.5,
          o.width,
          o.height};
}

RgbdCalibration KinectLike(const SynthOptions& options) {
  RgbdCalibration calibration;
  calibration.color = Scaled(526.3, 526.9, 321.4, 238.2, options);
  calibration.depth = Scaled(584.6, 584.1, 318.7, 241.5, options);
  Vector6d twist;
  twist << 0.0021, -0.0033, 0.0012, 0, 0, 0;
  calibration.color_from_depth = ExpSe3(twist);
  calibration.color_from_depth.translation = {-0.0231, 0.0006, -0.0012};
  return calibration;
}

// What shading needs of the faces, once a picture.
struct FaceNormals {
  explicit FaceNormals(const TriMesh& mesh) : normals(mesh.NumFaces()) {
    for (size_t f = 0; f < normals.size(); ++f) {
      normals[f] = mesh.FaceCross(f).normalized().cast<float>();
    }
  }
  std::vector<Vector3f> normals;
};

Vector3f ShadeHit(
    const SynthScan& scan, int face, float u, float v, float footprint) {
  const auto& uv = scan.room.face_uv[face];
  const Eigen::Vector2f at = (1 - u - v) * uv[0] + u * uv[1] + v * uv[2];
  return scan.textures[scan.room.face_surface[face]].Sample(
      at.x(), at.y(), footprint);
}

Pose ColorPose(const SynthScan& scan, int i) {
  return scan.calibration.color_from_depth * scan.true_poses[i];
}

}  // namespace

SynthScan MakeRoom(uint64_t seed, const SynthOptions& options) {
  CheckOptions(options);
  SynthScan scan;
  scan.seed = seed;
  scan.options = options;
  scan.room = BuildRoom(seed);
  scan.scene = std::make_shared<RayScene>(scan.room.mesh);
  scan.calibration = KinectLike(options);
  scan.true_poses =
      HandHeldPath(scan.room, *scan.scene, options.num_frames, seed);
  scan.given_poses = PerturbPoses(
      scan.true_poses, options.pose_noise_mm, options.pose_noise_deg, seed);
  scan.gains.assign(options.num_frames, 1.0);
  if (options.exposure_drift) {
    Random random(SplitMix64(seed ^ 0x6761696e));
    const Wander wander(1, 6, &random);
    for (int i = 0; i < options.num_frames; ++i) {
      scan.gains[i] = std::exp(0.12 * wander((i + 0.5) / options.num_frames));
    }
  }
  scan.textures = BakeRoom(scan.room, *scan.scene, options.bake);
  return scan;
}

std::vector<float> RenderRoom(const SynthScan& scan,
                              const Pinhole& camera,
                              const Pose& cam_from_world,
                              int supersampling) {
  const int s = supersampling;
  const Pinhole fine = {camera.fx * s,
                        camera.fy * s,
                        (camera.cx + 0.5) * s - 0.5,
                        (camera.cy + 0.5) * s - 0.5,
                        camera.width * s,
                        camera.height * s};
  const DepthRender hits = RenderDepth(*scan.scene, fine, cam_from_world);
  const FaceNormals faces(scan.room.mesh);
  const Eigen::Matrix3f rotation =
      cam_from_world.RotationMatrix().cast<float>();
  const float focal = static_cast<float>(std::min(fine.fx, fine.fy));
  std::vector<float> rgb(3 * static_cast<size_t>(camera.width) * camera.height);
  ParallelFor(
      0,
      camera.height,
      [&](size_t y) {
        for (int x = 0; x < camera.width; ++x) {
          Vector3f sum = Vector3f::Zero();
          for (int k = 0; k < s * s; ++k) {
            const int fx = x * s + k % s, fy = static_cast<int>(y) * s + k / s;
            const size_t i = static_cast<size_t>(fy) * fine.width + fx;
            const int face = hits.face[i];
            if (face < 0) continue;
            const Vector3f ray = fine.Unproject(fx, fy).cast<float>();
            const float cosine =
                std::abs((rotation * faces.normals[face]).dot(ray)) /
                ray.norm();
            const float footprint =
                hits.depth[i] / focal / std::sqrt(std::max(cosine, 0.1f));
            sum += ShadeHit(scan, face, hits.u[i], hits.v[i], footprint);
          }
          float* out = &rgb[3 * (y * camera.width + x)];
          for (int c = 0; c < 3; ++c) out[c] = sum[c] / (s * s);
        }
      },
      8);
  return rgb;
}

cv::Mat RenderSynthColor(const SynthScan& scan, int i) {
  const SynthOptions& o = scan.options;
  const Pinhole& camera = scan.calibration.color;
  std::vector<float> exact;
  const int next = std::min(i + 1, o.num_frames - 1);
  if (o.motion_blur && next > i) {
    // The mean over the time the shutter is open.
    constexpr int kSteps = 7;
    constexpr double kOpen = 0.5;
    const Pose start = ColorPose(scan, i);
    const Vector6d motion = LogSe3(ColorPose(scan, next) * start.Inverse());
    for (int k = 0; k < kSteps; ++k) {
      const double t = kOpen * ((k + 0.5) / kSteps - 0.5);
      const std::vector<float> step =
          RenderRoom(scan, camera, ExpSe3(t * motion) * start, 1);
      exact.resize(step.size(), 0);
      for (size_t j = 0; j < step.size(); ++j) exact[j] += step[j] / kSteps;
    }
  } else {
    exact = RenderRoom(scan, camera, ColorPose(scan, i), o.supersampling);
  }
  ColorSensorOptions sensor;
  sensor.noise_grey = o.color_noise_grey;
  sensor.vignetting = o.vignetting ? 0.3 : 0;
  sensor.gain = scan.gains[i];
  const uint64_t seed = SplitMix64(scan.seed * 0x10001 + 2 * i);
  const std::vector<uint8_t> rgb =
      SenseColor(camera.width, camera.height, exact, seed, sensor);
  cv::Mat image(camera.height, camera.width, CV_8UC3);
  std::copy(rgb.begin(), rgb.end(), image.data);
  return image;
}

cv::Mat RenderSynthDepth(const SynthScan& scan, int i) {
  const Pinhole& camera = scan.calibration.depth;
  const Pose& pose = scan.true_poses[i];
  const DepthRender hits = RenderDepth(*scan.scene, camera, pose);
  const double shift = scan.calibration.depth_shift;
  cv::Mat image(camera.height, camera.width, CV_16U);
  auto* out = image.ptr<uint16_t>();
  if (!scan.options.depth_noise) {
    for (size_t k = 0; k < hits.depth.size(); ++k) {
      out[k] = static_cast<uint16_t>(
          std::clamp(std::lround(hits.depth[k] * shift), 0L, 65534L));
    }
    return image;
  }
  const FaceNormals faces(scan.room.mesh);
  const Eigen::Matrix3f rotation = pose.RotationMatrix().cast<float>();
  std::vector<float> angle(hits.depth.size(), 0);
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const size_t k = static_cast<size_t>(y) * camera.width + x;
      if (hits.face[k] < 0) continue;
      const Vector3f ray = camera.Unproject(x, y).cast<float>().normalized();
      const float cosine =
          std::abs((rotation * faces.normals[hits.face[k]]).dot(ray));
      angle[k] = std::acos(std::min(cosine, 1.0f));
    }
  }
  const uint64_t seed = SplitMix64(scan.seed * 0x10001 + 2 * i + 1);
  const std::vector<uint16_t> raw = SenseDepth(
      camera, hits.depth, angle, shift, seed, scan.options.depth_sensor);
  std::copy(raw.begin(), raw.end(), out);
  return image;
}

}  // namespace facet
