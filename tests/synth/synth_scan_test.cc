// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "synth/synth_scan.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "mesh/mesh_io.h"
#include "rgbd/sequence.h"
#include "rgbd/trajectory_io.h"
#include "synth/camera_path.h"
#include "tests/support/temp_dir.h"
#include "util/atomic_file.h"
#include "util/errors.h"
#include "util/parallel_for.h"

namespace facet {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

SynthOptions SmallOptions() {
  SynthOptions options;
  options.num_frames = 40;
  options.width = 160;
  options.height = 120;
  options.depth_noise = false;
  options.color_noise_grey = 0;
  options.bake.room_step = 0.01;
  options.bake.thing_step = 0.008;
  options.bake.light_step = 0.4;
  return options;
}

// One room for the tests that only look at it.
const SynthScan& CleanScan() {
  static const SynthScan* scan = new SynthScan(MakeRoom(1, SmallOptions()));
  return *scan;
}

// Breaks when the way leaves the room or comes too near to things, or jumps.
TEST(SynthScan, CameraKeepsItsDistanceAndMovesSmoothly) {
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    const SynthRoom room = BuildRoom(seed);
    const RayScene scene(room.mesh);
    const auto poses = HandHeldPath(room, scene, 200, seed);
    for (size_t i = 0; i < poses.size(); ++i) {
      const Vector3d eye = poses[i].CenterInSource();
      EXPECT_TRUE((eye.array() > 0.5).all() &&
                  (eye.array() < room.size.array() - 0.5).all());
      EXPECT_GT(scene.NearestPoint(eye).distance, 0.6);
      if (i == 0) continue;
      const Pose motion = poses[i] * poses[i - 1].Inverse();
      EXPECT_LT(RotationAngle(motion), 0.25);
      EXPECT_LT((eye - poses[i - 1].CenterInSource()).norm(), 0.2);
    }
  }
}

// Breaks when labels, stored planes and geometry disagree, or a surface of the
// shell faces outwards.
TEST(SynthScan, TruePlanesContainTheirFaces) {
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    const SynthRoom room = BuildRoom(seed);
    const Vector3d center = 0.5 * room.size;
    int curved = 0;
    for (size_t f = 0; f < room.mesh.NumFaces(); ++f) {
      const RoomSurface& surface = room.surfaces[room.face_surface[f]];
      ASSERT_EQ(room.face_plane[f], surface.curved ? -1 : room.face_surface[f]);
      curved += surface.curved;
      EXPECT_GT(room.mesh.FaceArea(f), 0);
      if (surface.curved) continue;
      for (int v : room.mesh.faces[f]) {
        EXPECT_NEAR(
            surface.plane.SignedDistance(room.mesh.vertices[v]), 0, 1e-9);
      }
      EXPECT_GT(room.mesh.FaceCross(f).normalized().dot(surface.plane.normal),
                1 - 1e-9);
      if (surface.name.rfind("wall_", 0) == 0 || surface.name == "floor") {
        EXPECT_GT(surface.plane.SignedDistance(center), 1);
      }
    }
    EXPECT_GT(curved, 1000);
  }
}

// Breaks when the shell leaks (recesses that do not close) or a chart does not
// lie where its mesh is.
TEST(SynthScan, RoomIsClosedAndChartsMatchTheMesh) {
  const SynthScan& scan = CleanScan();
  const SynthRoom& room = scan.room;
  for (size_t i = 0; i < scan.true_poses.size(); i += 3) {
    const DepthRender hits =
        RenderDepth(*scan.scene, scan.calibration.depth, scan.true_poses[i]);
    EXPECT_EQ(std::count(hits.face.begin(), hits.face.end(), -1), 0);
  }
  for (size_t f = 0; f < room.mesh.NumFaces(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector2f uv = room.face_uv[f][k];
      const SurfacePoint point =
          room.surfaces[room.face_surface[f]].at(uv.x(), uv.y());
      EXPECT_LT(
          (point.position - room.mesh.vertices[room.mesh.faces[f][k]]).norm(),
          1e-4);  // float charts on a steep profile
    }
  }
}

// Breaks when poses, intrinsics or depth conventions disagree: a depth pixel of
// frame i carried into frame j must meet j's depth unless something is in
// front.
TEST(SynthScan, DepthOfOneFrameAgreesWithAnother) {
  const SynthScan& scan = CleanScan();
  const Pinhole& camera = scan.calibration.depth;
  int agree = 0, behind = 0, total = 0;
  for (int i = 0; i + 2 < 40; i += 4) {
    const cv::Mat a = RenderSynthDepth(scan, i);
    const cv::Mat b = RenderSynthDepth(scan, i + 2);
    const Pose b_from_a = scan.true_poses[i + 2] * scan.true_poses[i].Inverse();
    for (int y = 0; y < camera.height; y += 3) {
      for (int x = 0; x < camera.width; x += 3) {
        const double z = a.at<uint16_t>(y, x) / 1000.0;
        const Vector3d p = b_from_a * (z * camera.Unproject(x, y));
        if (p.z() < 0.1) continue;
        const Vector2d u = camera.Project(p);
        if (!camera.Contains(u, 1)) continue;
        const int bx = static_cast<int>(std::lround(u.x()));
        const int by = static_cast<int>(std::lround(u.y()));
        // The range of depth over the pixel's neighbours.
        double low = 1e9, high = 0;
        for (int k = 0; k < 9; ++k) {
          const double d =
              b.at<uint16_t>(by - 1 + k / 3, bx - 1 + k % 3) / 1000.0;
          low = std::min(low, d);
          high = std::max(high, d);
        }
        ++total;
        agree += p.z() > low - 0.003 && p.z() < high + 0.003;
        behind += p.z() >= high + 0.003;
      }
    }
  }
  ASSERT_GT(total, 4000);
  // Never in front of what b sees, but for slivers thinner than its pixels.
  EXPECT_GT(agree + behind, 0.995 * total);
  EXPECT_GT(agree, 0.9 * total);
}

// Breaks when colour depends on the view, or the colour camera is not where the
// calibration says.
TEST(SynthScan, ColourOfAPointIsTheSameFromEverywhere) {
  const SynthScan& scan = CleanScan();
  const Pinhole& camera = scan.calibration.color;
  std::vector<double> differences;
  for (int i = 0; i + 1 < 40; i += 6) {
    const cv::Mat a = RenderSynthColor(scan, i);
    const cv::Mat b = RenderSynthColor(scan, i + 1);
    const cv::Mat depth = RenderSynthDepth(scan, i);
    const Pose a_from_depth = scan.calibration.color_from_depth;
    const Pose b_from_depth =
        a_from_depth * scan.true_poses[i + 1] * scan.true_poses[i].Inverse();
    const auto grey = [&](const cv::Mat& image, const Vector2d& u) {
      const int x = static_cast<int>(u.x()), y = static_cast<int>(u.y());
      const double fx = u.x() - x, fy = u.y() - y;
      const auto at = [&](int px, int py) {
        const auto& c = image.at<cv::Vec3b>(py, px);
        return (c[0] + c[1] + c[2]) / 3.0;
      };
      return (1 - fy) * ((1 - fx) * at(x, y) + fx * at(x + 1, y)) +
             fy * ((1 - fx) * at(x, y + 1) + fx * at(x + 1, y + 1));
    };
    for (int y = 1; y < 119; y += 2) {
      for (int x = 1; x < 159; x += 2) {
        const Vector3d p = depth.at<uint16_t>(y, x) / 1000.0 *
                           scan.calibration.depth.Unproject(x, y);
        const Vector3d pa = a_from_depth * p, pb = b_from_depth * p;
        if (pa.z() < 0.2 || pb.z() < 0.2) continue;
        const Vector2d ua = camera.Project(pa), ub = camera.Project(pb);
        if (!camera.Contains(ua, 2) || !camera.Contains(ub, 2)) continue;
        differences.push_back(std::abs(grey(a, ua) - grey(b, ub)));
      }
    }
  }
  ASSERT_GT(differences.size(), 5000u);
  std::sort(differences.begin(), differences.end());
  EXPECT_LT(differences[differences.size() / 2], 2);
  EXPECT_LT(differences[differences.size() * 8 / 10], 6);
}

// Breaks when noise is biased, of the wrong size, or there are no holes.
TEST(SynthScan, DepthNoiseIsThatOfTheModel) {
  const Pinhole camera = {292, 292, 159.5, 119.5, 320, 240};
  for (double z : {1.0, 2.0, 3.5}) {
    const std::vector<float> exact(320 * 240, static_cast<float>(z));
    const std::vector<float> angle(exact.size(), 0.2f);
    const auto raw =
        SenseDepth(camera, exact, angle, 1000, 7, DepthSensorOptions());
    double sum = 0, squares = 0;
    int count = 0;
    for (uint16_t r : raw) {
      if (r == 0) continue;
      sum += r / 1000.0 - z;
      squares += (r / 1000.0 - z) * (r / 1000.0 - z);
      ++count;
    }
    const double sigma = 0.0012 + 0.0019 * (z - 0.4) * (z - 0.4);
    ASSERT_GT(count, 70000);
    EXPECT_LT(std::abs(sum / count), 0.4 * sigma);
    EXPECT_NEAR(std::sqrt(squares / count), sigma, 0.25 * sigma);
  }
  // A near strip in front of a far wall: fringe and shadow are missing.
  std::vector<float> step(320 * 240, 3.0f);
  for (int y = 0; y < 240; ++y) {
    for (int x = 100; x < 200; ++x) step[y * 320 + x] = 1.0f;
  }
  const auto raw = SenseDepth(camera,
                              step,
                              std::vector<float>(step.size(), 0.0f),
                              1000,
                              7,
                              DepthSensorOptions());
  int left = 0, right = 0;
  for (int y = 0; y < 240; ++y) {
    for (int k = 3; k < 12; ++k) {
      left += raw[y * 320 + 99 - k] == 0;
      right += raw[y * 320 + 200 + k] == 0;
    }
  }
  EXPECT_GT(left, 240 * 8);  // f b (1/1 - 1/3) = 14.6 px of shadow
  EXPECT_EQ(right, 0);
  // Grazing surfaces are missing.
  const auto grazing = SenseDepth(camera,
                                  step,
                                  std::vector<float>(step.size(), 1.45f),
                                  1000,
                                  7,
                                  DepthSensorOptions());
  EXPECT_EQ(std::count(grazing.begin(), grazing.end(), 0),
            static_cast<ptrdiff_t>(grazing.size()));
}

// Breaks when the errors are not what the header defines.
TEST(PerturbPoses, EveryAxisHasTheRmsAskedFor) {
  const SynthScan& scan = CleanScan();
  const auto wrong = PerturbPoses(scan.true_poses, 5.0, 0.2, 3);
  Vector3d move = Vector3d::Zero(), turn = Vector3d::Zero();
  Vector3d mean = Vector3d::Zero();
  for (size_t i = 0; i < wrong.size(); ++i) {
    const Vector3d e = 1000 * (wrong[i].CenterInSource() -
                               scan.true_poses[i].CenterInSource());
    const Pose rotation(
        wrong[i].rotation * scan.true_poses[i].rotation.conjugate(),
        Vector3d::Zero());
    const Vector3d r = LogSe3(rotation).head<3>() * 180 / 3.14159265358979;
    move += e.cwiseAbs2() / wrong.size();
    turn += r.cwiseAbs2() / wrong.size();
    mean += e / wrong.size();
  }
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(std::sqrt(move[k]), 5.0, 1e-6);
    EXPECT_NEAR(std::sqrt(turn[k]), 0.2, 1e-6);
    EXPECT_NEAR(mean[k], 0, 1e-9);
  }
}

std::vector<std::string> SortedFiles(const std::string& path) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(path)) {
    names.push_back(entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

// Breaks when anything depends on the number of threads.
TEST(WriteSynthSequence, SameBytesAtOneAndTwoThreads) {
  SynthOptions options = SmallOptions();
  options.num_frames = 4;
  options.depth_noise = true;
  options.color_noise_grey = 1.5;
  options.exposure_drift = options.vignetting = options.motion_blur = true;
  options.pose_noise_mm = 5;
  const TempDir dir;
  const int before = NumThreads();
  for (int threads : {1, 2}) {
    SetNumThreads(threads);
    WriteSynthSequence(
        MakeRoom(2, options), dir / std::to_string(threads), false);
  }
  SetNumThreads(before);
  const auto names = SortedFiles(dir / "1");
  EXPECT_EQ(names.size(), 4u * 3u + 4u);
  ASSERT_EQ(names, SortedFiles(dir / "2"));
  for (const auto& name : names) {
    EXPECT_EQ(ReadFile(dir / ("1/" + name)), ReadFile(dir / ("2/" + name)))
        << name;
  }
}

// Breaks when facet cannot read what it wrote, or ground truth files disagree
// with the scan.
TEST(WriteSynthSequence, ReadsBackAsASequence) {
  SynthOptions options = SmallOptions();
  options.num_frames = 5;
  options.pose_noise_mm = 10;
  options.pose_noise_deg = 0.5;
  const SynthScan scan = MakeRoom(3, options);
  const TempDir dir;
  WriteSynthSequence(scan, dir / "scan", false);
  const auto sequence = OpenSequence(dir / "scan", SequenceOptions());
  ASSERT_EQ(sequence->frames().size(), 5u);
  EXPECT_NEAR(
      sequence->calibration().color.fx, scan.calibration.color.fx, 1e-6);
  EXPECT_NEAR((sequence->calibration().color_from_depth.translation -
               scan.calibration.color_from_depth.translation)
                  .norm(),
              0,
              1e-9);
  const auto poses = ReadPoses(dir / "scan/poses_true.txt");
  ASSERT_EQ(poses.size(), 5u);
  for (int i = 0; i < 5; ++i) {
    const Pose& given = sequence->frames()[i].depth_cam_from_world;
    EXPECT_LT((given.Matrix() - scan.given_poses[i].Matrix()).norm(), 1e-6);
    EXPECT_LT((poses[i].world_from_cam.Inverse().Matrix() -
               scan.true_poses[i].Matrix())
                  .norm(),
              1e-6);
    const cv::Mat depth = sequence->LoadDepth(i);
    const cv::Mat raw = RenderSynthDepth(scan, i);
    EXPECT_NEAR(
        depth.at<float>(60, 80), raw.at<uint16_t>(60, 80) / 1000.0, 1e-6);
  }
  const MeshFile mesh = ReadMesh(dir / "scan/mesh_true.ply");
  EXPECT_EQ(mesh.face_plane, scan.room.face_plane);
  const auto json =
      nlohmann::json::parse(ReadFile(dir / "scan/planes_true.json"));
  for (const auto& plane : json.at("planes")) {
    const Plane& expected = scan.room.surfaces[plane.at("id")].plane;
    EXPECT_NEAR(plane.at("offset").get<double>(), expected.offset, 1e-12);
  }
  EXPECT_THROW(WriteSynthSequence(scan, dir / "scan", false), OptionsError);
}

// Breaks when nonsense options are accepted.
TEST(SynthScan, RefusesBadOptions) {
  SynthOptions options = SmallOptions();
  options.num_frames = 0;
  EXPECT_THROW(MakeRoom(1, options), OptionsError);
  options = SmallOptions();
  options.pose_noise_mm = -1;
  EXPECT_THROW(MakeRoom(1, options), OptionsError);
}

}  // namespace
}  // namespace facet
