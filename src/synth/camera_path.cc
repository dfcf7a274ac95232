// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "synth/camera_path.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "synth/wander.h"

namespace facet {
namespace {

using Eigen::Vector3d;

constexpr double kTwoPi = 6.283185307179586;

Pose LookAlong(const Vector3d& eye, const Vector3d& forward, double roll) {
  const Vector3d z = forward.normalized();
  const Vector3d x = z.cross(Vector3d::UnitZ()).normalized();
  Eigen::Matrix3d world_from_cam;
  world_from_cam << x, z.cross(x), z;
  const Eigen::AngleAxisd turn(roll, Vector3d::UnitZ());
  return Pose(Eigen::Quaterniond(world_from_cam * turn.toRotationMatrix()), eye)
      .Inverse();
}

// Pushes the eyes away from what is too near and keeps the path smooth.
void KeepDistance(const SynthRoom& room,
                  const RayScene& scene,
                  double distance,
                  std::vector<Vector3d>* eyes) {
  const int n = static_cast<int>(eyes->size());
  for (int round = 0; round < 30; ++round) {
    for (Vector3d& eye : *eyes) {
      const NearestHit hit = scene.NearestPoint(eye, distance);
      if (hit.face < 0 || hit.distance <= 0) continue;
      eye += 0.4 * (distance - hit.distance) / hit.distance * (eye - hit.point);
      eye.z() = std::clamp(eye.z(), 1.15, room.size.z() - 0.75);
    }
    std::vector<Vector3d> smooth = *eyes;
    for (int i = 1; i + 1 < n; ++i) {
      smooth[i] = 0.5 * (*eyes)[i] + 0.25 * ((*eyes)[i - 1] + (*eyes)[i + 1]);
    }
    *eyes = smooth;
  }
}

// White noise and a smooth curve of equal rms, mean 0, together of rms 1.
std::vector<double> ErrorSeries(size_t n, Random* random) {
  const auto normalise = [](std::vector<double>* x) {
    double mean = 0, squares = 0;
    for (double v : *x) mean += v / x->size();
    for (double& v : *x) {
      v -= mean;
      squares += v * v;
    }
    const double rms = std::sqrt(squares / x->size());
    for (double& v : *x) v /= std::max(rms, 1e-12);
  };
  const Wander wander(0.7, 4.0, random);
  std::vector<double> jitter(n), drift(n);
  for (size_t i = 0; i < n; ++i) {
    jitter[i] = random->Normal();
    drift[i] = wander(static_cast<double>(i) / n);
  }
  normalise(&jitter);
  normalise(&drift);
  for (size_t i = 0; i < n; ++i) drift[i] += jitter[i];
  normalise(&drift);
  return drift;
}

}  // namespace

std::vector<Pose> HandHeldPath(const SynthRoom& room,
                               const RayScene& scene,
                               int count,
                               uint64_t seed) {
  Random random(SplitMix64(seed ^ 0x70617468));
  const double start = random.Uniform(0, kTwoPi);
  const double sense = random.Uniform() < 0.5 ? 1 : -1;
  const double sweep_phase = random.Uniform(0, kTwoPi);
  const Vector3d center(0.5 * room.size.x(), 0.5 * room.size.y(), 1.5);
  std::vector<Vector3d> eyes(count);
  std::vector<double> azimuths(count), pitches(count);
  for (int i = 0; i < count; ++i) {
    const double t = (i + 0.5) / count;
    const double angle = start + sense * 2 * kTwoPi * t;
    // Outwards in the first round, across the room in the second one; the turn
    // from one to the other runs against the round, so that it is slow.
    const double s = std::clamp((t - 0.30) / 0.24, 0.0, 1.0);
    const double across = s * s * (3 - 2 * s);
    const double stretch = 0.55 + 0.50 * across;
    eyes[i] =
        center + Vector3d(stretch * 0.27 * room.size.x() * std::cos(angle),
                          stretch * 0.25 * room.size.y() * std::sin(angle),
                          0.12 * std::sin(3.3 * angle));
    azimuths[i] = angle - sense * across * 0.5 * kTwoPi;
    pitches[i] =
        -0.14 - 0.22 * across + 0.40 * std::sin(kTwoPi * 5.5 * t + sweep_phase);
  }
  KeepDistance(room, scene, 0.8, &eyes);
  std::vector<Wander> shake;
  for (int k = 0; k < 6; ++k) shake.emplace_back(10, 32, &random);
  std::vector<Pose> poses(count);
  for (int i = 0; i < count; ++i) {
    const double t = (i + 0.5) / count;
    const double azimuth = azimuths[i] + 0.02 * shake[3](t);
    const double pitch = pitches[i] + 0.02 * shake[4](t);
    const Vector3d forward(std::cos(azimuth) * std::cos(pitch),
                           std::sin(azimuth) * std::cos(pitch),
                           std::sin(pitch));
    const Vector3d tremble(shake[0](t), shake[1](t), shake[2](t));
    const Vector3d tick(random.Normal(), random.Normal(), random.Normal());
    poses[i] = LookAlong(
        eyes[i] + 0.008 * tremble + 0.001 * tick, forward, 0.04 * shake[5](t));
  }
  return poses;
}

std::vector<Pose> PerturbPoses(const std::vector<Pose>& cam_from_world,
                               double noise_mm,
                               double noise_deg,
                               uint64_t seed) {
  if (cam_from_world.size() < 3 || (noise_mm <= 0 && noise_deg <= 0)) {
    return cam_from_world;
  }
  Random random(SplitMix64(seed ^ 0x6e6f697365));
  std::array<std::vector<double>, 6> series;
  for (auto& s : series) s = ErrorSeries(cam_from_world.size(), &random);
  std::vector<Pose> wrong(cam_from_world.size());
  for (size_t i = 0; i < wrong.size(); ++i) {
    const Vector3d move =
        1e-3 * noise_mm * Vector3d(series[0][i], series[1][i], series[2][i]);
    const Vector3d turn = noise_deg * kTwoPi / 360 *
                          Vector3d(series[3][i], series[4][i], series[5][i]);
    Vector6d twist = Vector6d::Zero();
    twist.head<3>() = turn;
    const Eigen::Quaterniond rotation =
        ExpSe3(twist).rotation * cam_from_world[i].rotation;
    const Vector3d center = cam_from_world[i].CenterInSource() + move;
    wrong[i] = Pose(rotation, -(rotation * center));
  }
  return wrong;
}

}  // namespace facet
