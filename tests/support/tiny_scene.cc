// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "tests/support/tiny_scene.h"

#include <cmath>
#include <limits>

#include "costs/plane_manifold.h"
#include "costs/se3_manifold.h"
#include "problems/color_step.h"
#include "util/random.h"

namespace facet {
namespace {

constexpr double kPi = 3.14159265358979;
constexpr double kWallSize = 1.6;     // [m], of the part that carries texels
constexpr double kFirstTexel = 0.08;  // [m], away from the edges of the room

// Wall j is the plane x_j = 0; its two coordinates are the other two axes.
double Paint(int wall, const Eigen::Vector3d& q, double contrast) {
  const double a = q[(wall + 1) % 3], b = q[(wall + 2) % 3];
  const double waves = std::cos(13.0 * a + 4.0 * b + wall) +
                       std::cos(-6.0 * a + 11.0 * b + 2.0 * wall + 1.0) +
                       std::cos(9.0 * a + 9.0 * b + 0.7) +
                       std::cos(17.0 * (a - 0.6 * b) + 3.0 * wall);
  return 0.5 + contrast * 0.25 * waves;
}

// Luma of the ray origin + t * direction in the room x, y, z >= 0.
double Trace(const Eigen::Vector3d& origin,
             const Eigen::Vector3d& direction,
             double contrast) {
  int wall = -1;
  double nearest = std::numeric_limits<double>::infinity();
  for (int j = 0; j < 3; ++j) {
    const double t = -origin[j] / direction[j];
    if (t > 0 && t < nearest) {
      nearest = t;
      wall = j;
    }
  }
  if (wall < 0) return 0.5;
  return Paint(wall, origin + nearest * direction, contrast);
}

// A camera at `center` that looks at `target`, the world's z axis up.
Pose LookAt(const Eigen::Vector3d& center, const Eigen::Vector3d& target) {
  const Eigen::Vector3d z = (target - center).normalized();
  const Eigen::Vector3d x = z.cross(Eigen::Vector3d::UnitZ()).normalized();
  Eigen::Matrix3d r;
  r << x.transpose(), z.cross(x).transpose(), z.transpose();
  return Pose(Eigen::Quaterniond(r), -(r * center));
}

std::vector<Pose> PlaceCameras(int count) {
  Random random(17);
  std::vector<Pose> poses;
  for (int k = 0; k < count; ++k) {
    const double angle = kPi / 4 + 0.5 * (2.0 * k / (count - 1.0) - 1.0);
    const double radius = random.Uniform(2.0, 2.6);
    const Eigen::Vector3d center(radius * std::cos(angle),
                                 radius * std::sin(angle),
                                 random.Uniform(1.0, 1.9));
    const Eigen::Vector3d target(random.Uniform(0.3, 0.6),
                                 random.Uniform(0.3, 0.6),
                                 random.Uniform(0.3, 0.6));
    poses.push_back(LookAt(center, target));
  }
  return poses;
}

std::vector<float> Render(const TinySceneOptions& options,
                          const Pinhole& camera,
                          const Pose& cam_from_world,
                          int keyframe) {
  const Pose world_from_cam = cam_from_world.Inverse();
  std::vector<float> pixels;
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const Eigen::Vector2d target(x, y);
      Eigen::Vector2d u = target;
      for (int i = 0; options.displacement && i < 12; ++i) {
        u = target - options.displacement(keyframe, u);
      }
      const Eigen::Vector3d direction =
          world_from_cam.rotation * camera.Unproject(u.x(), u.y());
      pixels.push_back(static_cast<float>(
          Trace(world_from_cam.translation, direction, options.contrast)));
    }
  }
  return pixels;
}

void AddTexels(const TinySceneOptions& options, TinyScene* scene) {
  TexelSet& texels = scene->problem.texels;
  texels.spacing_m = options.texel_spacing_m;
  const int n =
      static_cast<int>((kWallSize - kFirstTexel) / options.texel_spacing_m);
  for (int wall = 0; wall < 3; ++wall) {
    Plane plane;
    plane.normal = Eigen::Vector3d::Unit(wall);
    scene->planes.push_back(plane);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (int i = 0; i < n; ++i) {
      for (int k = 0; k < n; ++k) {
        Eigen::Vector3d p;
        p[(wall + 1) % 3] = kFirstTexel + i * options.texel_spacing_m;
        p[(wall + 2) % 3] = kFirstTexel + k * options.texel_spacing_m;
        p[wall] = options.relief_m *
                  std::cos(2 * kPi * (3.0 * i + 2.0 * k) / n + 0.4);
        sum += p;
        texels.position.push_back(p.cast<float>());
        texels.plane.push_back(wall);
        texels.face.push_back(wall);
        texels.bary.push_back({0, 0});
      }
    }
    scene->problem.anchors.push_back(sum / (1.0 * n * n));
  }
}

// Everything that projects into an image with a margin, in two images or more.
void Observe(const TinySceneOptions& options, TinyScene* scene) {
  TextureProblem& problem = scene->problem;
  std::vector<std::vector<char>> sees;
  std::vector<int> views(problem.texels.size(), 0);
  for (const Pose& pose : scene->cam_from_world) {
    sees.emplace_back(problem.texels.size(), 0);
    for (size_t i = 0; i < views.size(); ++i) {
      const Eigen::Vector3d y =
          pose * scene->planes[problem.texels.plane[i]].Project(
                     problem.texels.position[i].cast<double>());
      sees.back()[i] = y.z() > 0.3 && problem.camera.Contains(
                                          problem.camera.Project<double>(y),
                                          options.image_margin_px);
      views[i] += sees.back()[i];
    }
  }
  problem.observations.begin = {0};
  for (const std::vector<char>& seen : sees) {
    for (uint32_t i = 0; i < views.size(); ++i) {
      if (seen[i] && views[i] > 1) problem.observations.texel.push_back(i);
    }
    problem.observations.begin.push_back(problem.observations.size());
  }
}

}  // namespace

TinyScene MakeTinyScene(const TinySceneOptions& options) {
  TinyScene scene;
  TextureProblem& problem = scene.problem;
  const double focal = 0.9 * options.width;
  problem.camera = {focal,
                    focal,
                    0.5 * (options.width - 1) + 0.3,
                    0.5 * (options.height - 1) - 0.4,
                    options.width,
                    options.height};
  problem.lattice = {options.lattice_columns,
                     options.lattice_rows,
                     options.width,
                     options.height};
  scene.cam_from_world = PlaceCameras(options.keyframes);
  problem.initial_cam_from_world = scene.cam_from_world;
  for (int k = 0; k < options.keyframes; ++k) {
    scene.pixels.push_back(
        Render(options, problem.camera, scene.cam_from_world[k], k));
    problem.images.push_back({scene.pixels.back().data(),
                              options.width,
                              options.height,
                              options.width});
  }
  problem.raw_images = problem.images;
  AddTexels(options, &scene);
  if (options.tile_texels > 0) {
    problem.tiles = SortTexelsIntoTiles(
        scene.planes, problem.anchors, options.tile_texels, &problem.texels);
  }
  Observe(options, &scene);
  FinishTextureProblem(&problem);
  scene.truth = InitialState(problem, scene.planes);
  return scene;
}

namespace {

Eigen::Vector3d RandomDirection(Random* random) {
  const double x = random->Normal(), y = random->Normal();
  return Eigen::Vector3d(x, y, random->Normal()).normalized();
}

}  // namespace

void AddDepthMoments(TinyScene* scene) {
  TextureProblem& problem = scene->problem;
  for (int k = 0; k < problem.NumKeyframes(); ++k) {
    std::vector<DepthMoment> moments(problem.NumPlanes());
    for (size_t i = problem.observations.begin[k];
         i < problem.observations.begin[k + 1];
         ++i) {
      const uint32_t texel = problem.observations.texel[i];
      const int j = problem.texels.plane[texel];
      const Eigen::Vector3d x =
          scene->cam_from_world[k] *
          scene->planes[j].Project(
              problem.texels.position[texel].cast<double>());
      const Eigen::Vector4d m = x.homogeneous();
      moments[j].moment += 1e6 * m * m.transpose();
      moments[j].keyframe = k;
      moments[j].plane = j;
      ++moments[j].samples;
    }
    for (const DepthMoment& moment : moments) {
      if (moment.samples > 0) problem.depth_moments.push_back(moment);
    }
  }
}

void PerturbPoses(double rotation_rad,
                  double translation_m,
                  uint64_t seed,
                  ReconState* state) {
  Random random(seed);
  for (size_t k = 0; k < state->poses.size() / kPoseSize; ++k) {
    Vector6d xi;
    xi.head<3>() = rotation_rad * RandomDirection(&random);
    xi.tail<3>() = translation_m * RandomDirection(&random);
    double* block = state->poses.data() + kPoseSize * k;
    PoseToBlock(ExpSe3(xi) * PoseFromBlock(block), block);
  }
}

void PerturbPlanes(double tilt_rad,
                   double offset_m,
                   uint64_t seed,
                   ReconState* state) {
  Random random(seed);
  for (size_t j = 0; j < state->planes.size() / kPlaneSize; ++j) {
    double* block = state->planes.data() + kPlaneSize * j;
    Eigen::Map<Eigen::Vector3d> normal(block);
    const Eigen::Vector3d axis =
        normal.cross(RandomDirection(&random)).normalized();
    normal = Eigen::AngleAxisd(tilt_rad, axis) * Eigen::Vector3d(normal);
    block[3] += random.Uniform() < 0.5 ? -offset_m : offset_m;
  }
}

EnergyWeights StartFrom(ReconState* state, TextureProblem* problem) {
  for (int k = 0; k < problem->NumKeyframes(); ++k) {
    problem->initial_cam_from_world[k] = state->CamFromWorld(k);
  }
  SolveColors(*problem, state);
  EnergyWeights weights;
  weights.lambda1 = InitialLambda1(*problem, weights, *state);
  weights.prior.scale = InitialPriorScale(*problem, weights, *state);
  return weights;
}

StateError CompareToTruth(const TinyScene& scene, const ReconState& state) {
  const int num_frames = scene.problem.NumKeyframes();
  // found_k = truth_k * slip for all k, as well as possible.
  Pose slip;
  for (int iteration = 0; iteration < 5; ++iteration) {
    Vector6d mean = Vector6d::Zero();
    for (int k = 0; k < num_frames; ++k) {
      mean += LogSe3(scene.cam_from_world[k].Inverse() * state.CamFromWorld(k) *
                     slip.Inverse());
    }
    slip = ExpSe3(mean / num_frames) * slip;
  }
  StateError error;
  for (int k = 0; k < num_frames; ++k) {
    const Pose found = state.CamFromWorld(k) * slip.Inverse();
    const Pose& truth = scene.cam_from_world[k];
    error.rotation_rad +=
        std::pow(RotationAngle(found * truth.Inverse()), 2) / num_frames;
    error.center_m +=
        (found.CenterInSource() - truth.CenterInSource()).squaredNorm() /
        num_frames;
  }
  const int num_planes = scene.problem.NumPlanes();
  for (int j = 0; j < num_planes; ++j) {
    const Eigen::Vector3d& anchor = scene.problem.anchors[j];
    const Plane found = state.PlaneAt(j, anchor);
    // x_aligned = slip * x_found; the plane moves along.
    const Eigen::Vector3d normal = slip.rotation * found.normal;
    const double offset = found.offset - normal.dot(slip.translation);
    const Plane& truth = scene.planes[j];
    error.normal_rad +=
        std::pow(normal.cross(truth.normal).norm(), 2) / num_planes;
    error.offset_m +=
        std::pow(normal.dot(anchor) + offset - truth.SignedDistance(anchor),
                 2) /
        num_planes;
  }
  for (double* value : {&error.rotation_rad,
                        &error.center_m,
                        &error.normal_rad,
                        &error.offset_m}) {
    *value = std::sqrt(*value);
  }
  return error;
}

}  // namespace facet
