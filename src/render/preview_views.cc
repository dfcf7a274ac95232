// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "render/preview_views.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "util/parallel_for.h"

namespace facet {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kPi = 3.14159265358979323846;

// The box along three axes that holds nearly all of the surface, whatever a few
// stray pieces of a scan do.
struct Extent {
  Vector3d low, high;
  Vector3d Center() const { return 0.5 * (low + high); }
};

Extent RobustExtent(const TriMesh& mesh, const Matrix3d& axes) {
  constexpr double kTail = 1.0 / 60;  // of the area, at every end
  // Every vertex stands for the area around it, so that large faces reach to
  // their corners and small ones do not outweigh them.
  std::vector<double> area(mesh.NumVertices(), 0);
  double total = 0;
  for (size_t f = 0; f < mesh.NumFaces(); ++f) {
    const double share = mesh.FaceArea(f);
    for (int v : mesh.faces[f]) area[v] += share;
    total += 3 * share;
  }
  std::vector<std::pair<double, double>> values(mesh.NumVertices());
  Extent extent;
  for (int k = 0; k < 3; ++k) {
    for (size_t i = 0; i < values.size(); ++i) {
      values[i] = {axes.col(k).dot(mesh.vertices[i]), area[i]};
    }
    std::sort(values.begin(), values.end());
    const auto quantile = [&](auto begin, auto end) {
      double sum = 0;
      auto it = begin;
      while (it + 1 != end && (sum += it->second) <= kTail * total) ++it;
      return it->first;
    };
    extent.low[k] = quantile(values.begin(), values.end());
    extent.high[k] = quantile(values.rbegin(), values.rend());
  }
  return extent;
}

// Area vectors summed over the faces of similar direction: 6 sides of a cube
// of kBins^2 bins each.
std::vector<Vector3d> DirectionHistogram(const TriMesh& mesh) {
  constexpr int kBins = 24;
  std::vector<Vector3d> bins(6 * kBins * kBins, Vector3d::Zero());
  for (size_t f = 0; f < mesh.NumFaces(); ++f) {
    const Vector3d n = mesh.FaceCross(f);
    int k = 0;
    const double largest = n.cwiseAbs().maxCoeff(&k);
    if (!(largest > 0)) continue;
    const auto bin = [&](double x) {
      return std::clamp(
          static_cast<int>(0.5 * (x / largest + 1) * kBins), 0, kBins - 1);
    };
    const int side = 2 * k + (n[k] > 0);
    const int a = bin(n[(k + 1) % 3]), b = bin(n[(k + 2) % 3]);
    bins[(side * kBins + a) * kBins + b] += n;
  }
  return bins;
}

// World axes as columns: x right, y up of a map seen from above, z = up.
Matrix3d UprightAxes(const Vector3d& up) {
  Vector3d x = up.unitOrthogonal();
  Matrix3d axes;
  axes << x, up.cross(x), up;
  return axes;
}

Pose LookAt(const Vector3d& eye, const Vector3d& target, const Vector3d& up) {
  const Vector3d z = (target - eye).normalized();
  const Vector3d x = z.cross(up).normalized();
  Matrix3d world_from_cam;
  world_from_cam << x, z.cross(x), z;
  return Pose(Eigen::Quaterniond(world_from_cam), eye).Inverse();
}

Pinhole CameraOf(const PreviewOptions& options, double fov_deg) {
  const double f = 0.5 * options.width / std::tan(0.5 * fov_deg * kPi / 180);
  return {f,
          f,
          0.5 * (options.width - 1),
          0.5 * (options.height - 1),
          options.width,
          options.height};
}

PreviewView ViewFromAbove(const TriMesh& mesh,
                          const Matrix3d& axes,
                          const PreviewOptions& options) {
  const Extent extent = RobustExtent(mesh, axes);
  const double elevation = options.above_elevation_deg * kPi / 180;
  const std::vector<Vector3d> histogram = DirectionHistogram(mesh);
  double best_area = -1;
  Vector3d best = axes.col(2);
  for (int i = 0; i < 32; ++i) {
    const double azimuth = 2 * kPi * i / 32;
    const Vector3d to_eye =
        axes * Vector3d(std::cos(elevation) * std::cos(azimuth),
                        std::cos(elevation) * std::sin(azimuth),
                        std::sin(elevation));
    double area = 0;
    for (const Vector3d& n : histogram) area += std::max(0.0, n.dot(to_eye));
    if (area > best_area) {
      best_area = area;
      best = to_eye;
    }
  }
  PreviewView view;
  view.name = "above";
  view.cull_back_faces = true;
  view.camera = CameraOf(options, 36);
  const Vector3d center = axes * extent.Center();
  // Far enough that all corners of the box are inside the picture, then moved
  // so that they are centred in it.
  Vector3d target = center;
  double distance = 1.0;
  for (int round = 0; round < 60; ++round) {
    view.cam_from_world = LookAt(target + distance * best, target, axes.col(2));
    Eigen::Vector2d low(1e30, 1e30), high(-1e30, -1e30);
    bool behind = false;
    for (int i = 0; i < 8; ++i) {
      const Vector3d corner =
          axes * Vector3d(i & 1 ? extent.high.x() : extent.low.x(),
                          i & 2 ? extent.high.y() : extent.low.y(),
                          i & 4 ? extent.high.z() : extent.low.z());
      const Vector3d y = view.cam_from_world * corner;
      behind |= y.z() < 0.1;
      const Eigen::Vector2d u = view.camera.Project(y);
      low = low.cwiseMin(u);
      high = high.cwiseMax(u);
    }
    const Eigen::Vector2d size(options.width, options.height);
    const double fill =
        behind ? 2 : ((high - low).array() / size.array()).maxCoeff() / 0.94;
    if (!behind) {
      const Eigen::Vector2d off =
          0.5 * (low + high) - 0.5 * (size - Eigen::Vector2d(1, 1));
      const Vector3d shift(off.x() * distance / view.camera.fx,
                           off.y() * distance / view.camera.fy,
                           0);
      target += view.cam_from_world.rotation.conjugate() * shift;
    }
    distance *= std::clamp(fill, 0.8, 1.5);
  }
  return view;
}

// Cells of 10 cm that a camera sees from their front side, sorted.
std::vector<uint64_t> SeenCells(const RayScene& scene,
                                const TriMesh& mesh,
                                const PreviewView& view) {
  constexpr int kStep = 16;
  Pinhole small = view.camera;
  small.fx /= kStep;
  small.fy /= kStep;
  small.cx = (small.cx + 0.5) / kStep - 0.5;
  small.cy = (small.cy + 0.5) / kStep - 0.5;
  small.width /= kStep;
  small.height /= kStep;
  const Pose world_from_cam = view.cam_from_world.Inverse();
  std::vector<uint64_t> cells;
  for (int y = 0; y < small.height; ++y) {
    for (int x = 0; x < small.width; ++x) {
      const Vector3d direction =
          world_from_cam.rotation * small.Unproject(x, y);
      const RayHit hit = scene.Intersect(world_from_cam.translation, direction);
      if (hit.face < 0 || hit.t < 0.5 || hit.t > 6 ||
          mesh.FaceCross(hit.face).dot(direction) > 0) {
        continue;
      }
      const Vector3d point = world_from_cam.translation + hit.t * direction;
      uint64_t key = 0;
      for (int k = 0; k < 3; ++k) {
        key = key << 21 |
              (static_cast<uint64_t>(std::floor(point[k] / 0.1) + (1 << 20)) &
               0x1fffff);
      }
      cells.push_back(key);
    }
  }
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  return cells;
}

std::vector<Pose> GridPoses(const TriMesh& mesh, const Matrix3d& axes) {
  const Extent extent = RobustExtent(mesh, axes);
  const Vector3d size = extent.high - extent.low;
  std::vector<Pose> poses;
  for (double fx : {0.15, 0.5, 0.85}) {
    for (double fy : {0.15, 0.5, 0.85}) {
      const Vector3d eye =
          axes * (extent.low + size.cwiseProduct(Vector3d(fx, fy, 0.62)));
      for (int i = 0; i < 12; ++i) {
        const double azimuth = 2 * kPi * i / 12;
        const Vector3d forward =
            axes * Vector3d(std::cos(azimuth), std::sin(azimuth), -0.3);
        poses.push_back(LookAt(eye, eye + forward, axes.col(2)));
      }
    }
  }
  return poses;
}

// The two candidates that together see most cells: greedy.
std::vector<PreviewView> InsideViews(const RayScene& scene,
                                     const TriMesh& mesh,
                                     const std::vector<Pose>& candidates,
                                     const PreviewOptions& options) {
  std::vector<PreviewView> views(candidates.size());
  std::vector<std::vector<uint64_t>> cells(candidates.size());
  ParallelFor(0, candidates.size(), [&](size_t i) {
    views[i].camera = CameraOf(options, options.inside_fov_deg);
    views[i].cam_from_world = candidates[i];
    cells[i] = SeenCells(scene, mesh, views[i]);
  });
  std::vector<PreviewView> chosen;
  std::vector<uint64_t> seen;
  for (int round = 0; round < 2; ++round) {
    size_t best = 0, best_gain = 0;
    for (size_t i = 0; i < candidates.size(); ++i) {
      std::vector<uint64_t> fresh;
      std::set_difference(cells[i].begin(),
                          cells[i].end(),
                          seen.begin(),
                          seen.end(),
                          std::back_inserter(fresh));
      if (fresh.size() > best_gain) {
        best_gain = fresh.size();
        best = i;
      }
    }
    chosen.push_back(views[best]);
    chosen.back().name = "inside_" + std::to_string(round + 1);
    seen = cells[best];
  }
  return chosen;
}

}  // namespace

Vector3d EstimateUp(const TriMesh& mesh,
                    const std::vector<Pose>& cam_from_world) {
  Vector3d mean_up = Vector3d::Zero();
  for (const Pose& pose : cam_from_world) {
    mean_up += pose.rotation.conjugate() * Vector3d(0, -1, 0);
  }
  const bool guided = mean_up.norm() > 1e-3;
  if (guided) mean_up.normalize();
  // Area by direction over a fixed set of normals, then a mean shift.
  std::vector<Vector3d> seeds;
  for (int i = 0; i < 400; ++i) {  // a Fibonacci sphere
    const double z = 1 - (2 * i + 1) / 400.0, angle = i * 2.399963229728653;
    const double r = std::sqrt(1 - z * z);
    const Vector3d d(r * std::cos(angle), r * std::sin(angle), z);
    if (!guided || d.dot(mean_up) > std::cos(50 * kPi / 180)) {
      seeds.push_back(d);
    }
  }
  const std::vector<Vector3d> histogram = DirectionHistogram(mesh);
  const auto mean_near = [&](const Vector3d& d, double cosine) {
    Vector3d sum = Vector3d::Zero();
    for (const Vector3d& n : histogram) {
      if (n.dot(d) > cosine * n.norm()) sum += n;
    }
    return sum;
  };
  std::vector<double> area;
  for (const Vector3d& seed : seeds) {
    area.push_back(mean_near(seed, std::cos(15 * kPi / 180)).norm());
  }
  Vector3d up =
      seeds[std::max_element(area.begin(), area.end()) - area.begin()];
  for (double degrees : {15.0, 12.0, 10.0, 10.0}) {
    const Vector3d sum = mean_near(up, std::cos(degrees * kPi / 180));
    if (sum.norm() > 0) up = sum.normalized();
  }
  return up;
}

std::vector<PreviewView> ChooseViews(const RayScene& scene,
                                     const TriMesh& mesh,
                                     const std::vector<Pose>& cam_from_world,
                                     const PreviewOptions& options) {
  const Matrix3d axes = UprightAxes(EstimateUp(mesh, cam_from_world));
  std::vector<PreviewView> views = {ViewFromAbove(mesh, axes, options)};
  const std::vector<Pose> candidates =
      cam_from_world.empty() ? GridPoses(mesh, axes) : cam_from_world;
  for (auto& view : InsideViews(scene, mesh, candidates, options)) {
    views.push_back(std::move(view));
  }
  return views;
}

}  // namespace facet
