// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "texture/charts.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <queue>
#include <string>

#include "util/errors.h"

namespace facet {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// Bits of the coverage map: 256 MB, 13,000 m^2 of a plane at 2.5 mm.
constexpr double kMaxChartPixels = 2147483648.0;

enum class FaceSide { kFront, kBack, kSteep };

double Cross(const Vector2d& a, const Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

// Counter-clockwise hull without collinear points (monotone chain).
std::vector<Vector2d> ConvexHull(std::vector<Vector2d> points) {
  std::sort(points.begin(), points.end(), [](const auto& a, const auto& b) {
    return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
  });
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return points;
  std::vector<Vector2d> hull;
  const auto add = [&](const Vector2d& p, size_t base) {
    while (hull.size() >= base + 2 &&
           Cross(hull.back() - hull[hull.size() - 2], p - hull.back()) <= 0) {
      hull.pop_back();
    }
    hull.push_back(p);
  };
  for (const auto& p : points) add(p, 0);
  const size_t base = hull.size() - 1;
  for (size_t i = points.size() - 1; i-- > 0;) add(points[i], base);
  hull.pop_back();
  return hull;
}

// A 2-D frame on a plane, and the box of what lies in it [px].
struct Frame {
  Vector3d base, e1, e2;
  Vector2d low = Vector2d::Constant(1e30), high = Vector2d::Constant(-1e30);

  Vector2d ToPixel(const Vector3d& v, double h) const {
    const Vector3d d = (v - base) / h;
    return {e1.dot(d), e2.dot(d)};
  }
};

class ClusterCharter {
 public:
  ClusterCharter(const TriMesh& mesh,
                 const std::vector<std::array<int, 3>>& neighbors,
                 const PlaneCluster& cluster,
                 int cluster_id,
                 const std::vector<int>& faces,
                 const ChartOptions& options)
      : mesh_(mesh),
        neighbors_(neighbors),
        cluster_(cluster),
        cluster_id_(cluster_id),
        faces_(faces),
        options_(options) {
    for (int face : faces_) {
      const Vector3d cross = mesh_.FaceCross(face);
      const double area = cross.norm();
      areas_.push_back(area);
      normals_.push_back(area > 0 ? Vector3d(cross / area)
                                  : cluster_.plane.normal);
      const double k = normals_.back().dot(cluster_.plane.normal);
      sides_.push_back(k >= options_.min_front_cos    ? FaceSide::kFront
                       : k <= -options_.min_front_cos ? FaceSide::kBack
                                                      : FaceSide::kSteep);
    }
    taken_.assign(faces_.size(), 0);
    overlapped_.assign(faces_.size(), 0);
  }

  std::vector<Chart> Build() {
    std::vector<int> seeds(faces_.size());
    for (size_t i = 0; i < seeds.size(); ++i) seeds[i] = static_cast<int>(i);
    std::stable_sort(seeds.begin(), seeds.end(), [this](int a, int b) {
      return areas_[a] > areas_[b];
    });
    for (int seed : seeds) {
      if (!taken_[seed]) GrowFrom(seed);
    }
    return std::move(charts_);
  }

 private:
  // Position of a face in faces_, or -1.
  int Local(int face) const {
    const auto it = std::lower_bound(faces_.begin(), faces_.end(), face);
    return it != faces_.end() && *it == face
               ? static_cast<int>(it - faces_.begin())
               : -1;
  }

  Vector3d ViewNormal(int seed) const {
    if (sides_[seed] == FaceSide::kSteep) return normals_[seed];
    return sides_[seed] == FaceSide::kFront ? cluster_.plane.normal
                                            : Vector3d(-cluster_.plane.normal);
  }

  bool Fits(int local, int seed, const Vector3d& normal) const {
    if (taken_[local] || sides_[local] != sides_[seed]) return false;
    return sides_[seed] != FaceSide::kSteep ||
           normals_[local].dot(normal) >= options_.steep_group_cos;
  }

  // All faces that edges connect to the seed, were there no overlap.
  std::vector<int> Reachable(int seed, const Vector3d& normal) const {
    std::vector<int> reached = {seed};
    std::vector<uint8_t> seen(faces_.size(), 0);
    seen[seed] = 1;
    for (size_t i = 0; i < reached.size(); ++i) {
      for (int neighbor : neighbors_[faces_[reached[i]]]) {
        const int local = neighbor < 0 ? -1 : Local(neighbor);
        if (local < 0 || seen[local] || !Fits(local, seed, normal)) continue;
        seen[local] = 1;
        reached.push_back(local);
      }
    }
    return reached;
  }

  Frame MakeFrame(const std::vector<int>& locals,
                  const Vector3d& normal) const {
    Frame frame;
    frame.base = cluster_.plane.Project(cluster_.centroid);
    // Any pair of axes first, then turned to the smallest rectangle.
    const Vector3d a = normal.unitOrthogonal(), b = a.cross(normal);
    std::vector<Vector2d> points;
    for (int local : locals) {
      for (int v : mesh_.faces[faces_[local]]) {
        const Vector3d d = mesh_.vertices[v] - frame.base;
        points.emplace_back(a.dot(d), b.dot(d));
      }
    }
    const Vector2d axis = MinAreaRectangleAxis(std::move(points));
    frame.e1 = axis.x() * a + axis.y() * b;
    frame.e2 = frame.e1.cross(normal);
    FindBox(locals, &frame);
    // Low and wide charts pack best.
    if (frame.high.y() - frame.low.y() > frame.high.x() - frame.low.x()) {
      frame.e1 = -frame.e2;
      frame.e2 = frame.e1.cross(normal);
      FindBox(locals, &frame);
    }
    return frame;
  }

  void FindBox(const std::vector<int>& locals, Frame* frame) const {
    frame->low.setConstant(1e30);
    frame->high.setConstant(-1e30);
    for (int local : locals) {
      for (int v : mesh_.faces[faces_[local]]) {
        const Vector2d p =
            frame->ToPixel(mesh_.vertices[v], options_.texel_size_m);
        frame->low = frame->low.cwiseMin(p);
        frame->high = frame->high.cwiseMax(p);
      }
    }
  }

  UvTriangle Triangle(int local, const Frame& frame) const {
    UvTriangle uv;
    const Vector2d low(std::floor(frame.low.x()), std::floor(frame.low.y()));
    for (int k = 0; k < 3; ++k) {
      const Vector3d& v = mesh_.vertices[mesh_.faces[faces_[local]][k]];
      uv[k] = frame.ToPixel(v, options_.texel_size_m) - low;
    }
    return uv;
  }

  void GrowFrom(int seed) {
    const Vector3d normal = ViewNormal(seed);
    const std::vector<int> reached = Reachable(seed, normal);
    const Frame frame = MakeFrame(reached, normal);
    const double width =
        std::ceil(frame.high.x()) - std::floor(frame.low.x()) + 1;
    const double height =
        std::ceil(frame.high.y()) - std::floor(frame.low.y()) + 1;
    const double size = width * height;
    if (size > kMaxChartPixels) {
      throw UnsolvableError("a plane of the mesh spans " +
                            std::to_string(static_cast<long long>(size)) +
                            " texels, more than can be held; raise the texel "
                            "size or check the unit of the mesh (metres)");
    }
    const int columns = static_cast<int>(width);
    const int rows = static_cast<int>(height);
    std::vector<bool> covered(static_cast<size_t>(size), false);
    std::vector<uint8_t> refused(faces_.size(), 0);
    std::vector<int> members;
    // Largest first, ties to the lowest face.
    std::priority_queue<std::pair<double, int>> queue;
    queue.emplace(areas_[seed], -seed);
    while (!queue.empty()) {
      const int local = -queue.top().second;
      queue.pop();
      if (refused[local] || !Fits(local, seed, normal)) continue;
      const UvTriangle uv = Triangle(local, frame);
      bool overlap = false;
      RasterizeTriangle(uv, columns, rows, [&](int col, int row) {
        overlap |= covered[static_cast<size_t>(row) * columns + col];
      });
      if (overlap) {
        refused[local] = overlapped_[local] = 1;
        continue;
      }
      RasterizeTriangle(uv, columns, rows, [&](int col, int row) {
        covered[static_cast<size_t>(row) * columns + col] = true;
      });
      taken_[local] = 1;
      members.push_back(local);
      for (int neighbor : neighbors_[faces_[local]]) {
        const int next = neighbor < 0 ? -1 : Local(neighbor);
        if (next >= 0 && !refused[next] && Fits(next, seed, normal)) {
          queue.emplace(areas_[next], -next);
        }
      }
    }
    bool folded = false;
    for (int local : members) folded |= overlapped_[local] != 0;
    EmitChart(std::move(members), frame, sides_[seed], folded);
  }

  // Makes the chart, or halves it along its longer side until it fits.
  void EmitChart(std::vector<int> locals,
                 Frame frame,
                 FaceSide side,
                 bool folded) {
    FindBox(locals, &frame);
    const Vector2d low(std::floor(frame.low.x()), std::floor(frame.low.y()));
    const int gutter = options_.gutter_px;
    const int width =
        static_cast<int>(std::ceil(frame.high.x()) - low.x()) + 2 * gutter;
    const int height =
        static_cast<int>(std::ceil(frame.high.y()) - low.y()) + 2 * gutter;
    const int limit = options_.max_size_px;
    if (locals.size() > 1 && (width > limit || height > limit)) {
      const int axis = width >= height ? 0 : 1;
      std::stable_sort(locals.begin(), locals.end(), [&](int a, int b) {
        return Middle(a, frame, axis) < Middle(b, frame, axis);
      });
      const double middle = 0.5 * (frame.low[axis] + frame.high[axis]);
      size_t cut = 0;
      while (cut < locals.size() && Middle(locals[cut], frame, axis) < middle) {
        ++cut;
      }
      if (cut == 0 || cut == locals.size()) cut = locals.size() / 2;
      const auto at = locals.begin() + static_cast<ptrdiff_t>(cut);
      EmitChart({locals.begin(), at}, frame, side, folded);
      EmitChart({at, locals.end()}, frame, side, folded);
      return;
    }
    Chart chart;
    chart.plane = cluster_id_;
    for (int local : locals) chart.faces.push_back(faces_[local]);
    std::sort(chart.faces.begin(), chart.faces.end());
    chart.e1 = frame.e1;
    chart.e2 = frame.e2;
    chart.origin =
        frame.base + options_.texel_size_m * ((low.x() - gutter) * frame.e1 +
                                              (low.y() - gutter) * frame.e2);
    chart.width = width;
    chart.height = height;
    chart.steep = side == FaceSide::kSteep;
    chart.back = side == FaceSide::kBack;
    chart.folded = folded;
    charts_.push_back(std::move(chart));
  }

  double Middle(int local, const Frame& frame, int axis) const {
    return frame.ToPixel(mesh_.FaceCentroid(faces_[local]),
                         options_.texel_size_m)[axis];
  }

  const TriMesh& mesh_;
  const std::vector<std::array<int, 3>>& neighbors_;
  const PlaneCluster& cluster_;
  const int cluster_id_;
  const std::vector<int>& faces_;
  const ChartOptions& options_;
  // By position in faces_.
  std::vector<double> areas_;
  std::vector<Vector3d> normals_;
  std::vector<FaceSide> sides_;
  std::vector<uint8_t> taken_, overlapped_;
  std::vector<Chart> charts_;
};

}  // namespace

Vector2d MinAreaRectangleAxis(std::vector<Vector2d> points) {
  const std::vector<Vector2d> hull = ConvexHull(std::move(points));
  Vector2d best = Vector2d::UnitX();
  double best_area = 1e300, best_side = 0;
  for (size_t i = 0; i < hull.size() && hull.size() >= 2; ++i) {
    const Vector2d edge = hull[(i + 1) % hull.size()] - hull[i];
    const Vector2d axis = edge.normalized(), normal(-axis.y(), axis.x());
    Vector2d low = Vector2d::Constant(1e300), high = -low;
    for (const auto& p : hull) {
      const Vector2d q(axis.dot(p), normal.dot(p));
      low = low.cwiseMin(q);
      high = high.cwiseMax(q);
    }
    const double area = (high - low).prod();
    // Among equal rectangles the one along the longest edge: stable on walls.
    if (area < best_area * (1 - 1e-9) ||
        (area <= best_area * (1 + 1e-9) && edge.norm() > best_side)) {
      best_area = area;
      best_side = edge.norm();
      best = axis;
    }
  }
  return best;
}

std::vector<std::array<int, 3>> ClusterNeighbors(
    const TriMesh& mesh, const std::vector<int>& face_cluster) {
  struct Side {
    int low, high, cluster, face, k;
  };
  std::vector<Side> sides;
  sides.reserve(3 * mesh.NumFaces());
  for (size_t f = 0; f < mesh.NumFaces(); ++f) {
    for (int k = 0; k < 3; ++k) {
      const int a = mesh.faces[f][k], b = mesh.faces[f][(k + 1) % 3];
      sides.push_back({std::min(a, b),
                       std::max(a, b),
                       face_cluster[f],
                       static_cast<int>(f),
                       k});
    }
  }
  const auto key = [](const Side& s) {
    return std::array<int, 5>{s.low, s.high, s.cluster, s.face, s.k};
  };
  std::sort(sides.begin(), sides.end(), [&](const Side& a, const Side& b) {
    return key(a) < key(b);
  });
  std::vector<std::array<int, 3>> neighbors(mesh.NumFaces(), {-1, -1, -1});
  for (size_t i = 0; i < sides.size();) {
    size_t end = i + 1;
    while (end < sides.size() && sides[end].low == sides[i].low &&
           sides[end].high == sides[i].high &&
           sides[end].cluster == sides[i].cluster) {
      ++end;
    }
    // A ring through all faces of the edge: for two faces, each the other.
    for (size_t j = i; j < end && end - i > 1; ++j) {
      const Side& other = sides[j + 1 < end ? j + 1 : i];
      neighbors[sides[j].face][sides[j].k] = other.face;
    }
    i = end;
  }
  return neighbors;
}

std::vector<Chart> BuildClusterCharts(
    const TriMesh& mesh,
    const std::vector<std::array<int, 3>>& neighbors,
    const PlaneCluster& cluster,
    int cluster_id,
    const std::vector<int>& faces,
    const ChartOptions& options) {
  return ClusterCharter(mesh, neighbors, cluster, cluster_id, faces, options)
      .Build();
}

}  // namespace facet
