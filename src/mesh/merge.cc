// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "mesh/merge.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <queue>
#include <string>

#include "mesh/partition.h"
#include "mesh/plane_graph.h"
#include "util/errors.h"
#include "util/warnings.h"

namespace facet {
namespace {

constexpr double kDegree = M_PI / 180;

void CheckOptions(const MergeOptions& o) {
  if (!(o.max_normal_deg > 0) || !(o.max_normal_deg <= 180) ||
      !(o.max_distance_m > 0) || !(o.min_sheet_deg >= 0) ||
      !(o.min_sheet_deg < 90)) {
    throw OptionsError(
        "merge: max_normal_deg must be in (0, 180], max_distance_m positive, "
        "min_sheet_deg in [0, 90)");
  }
  if (!(o.max_rms_m >= 0) || !(o.max_drift_factor >= 0) ||
      !(o.max_member_rms_m >= 0) || o.island_max_neighbors < 0 ||
      !(o.island_area_share >= 0) || !(o.island_area_m2 >= 0) ||
      !(o.island_max_rms_m >= 0) || !(o.island_border_share >= 0) ||
      !(o.island_border_share <= 1)) {
    throw OptionsError(
        "merge: guards and island limits must not be negative, "
        "island_border_share at most 1");
  }
}

// A pair of planes that may be merged, as they were at some moment.
struct Candidate {
  double cost = 0;
  int i = 0, j = 0;  // i < j
  int version_i = 0, version_j = 0;
  // For std::priority_queue, whose top is the greatest.
  bool operator<(const Candidate& other) const {
    if (cost != other.cost) return cost > other.cost;
    return i != other.i ? i > other.i : j > other.j;
  }
};

class PlaneMerger {
 public:
  PlaneMerger(const TriMesh& mesh,
              const PlanarPartition& partition,
              const MergeOptions& options,
              MergeReport* report)
      : mesh_(mesh),
        original_(partition.clusters.size()),
        original_moments_(partition.clusters.size()),
        options_(options),
        report_(*report),
        graph_(mesh, partition) {
    for (size_t i = 0; i < original_.size(); ++i) {
      original_[i] = graph_.node(static_cast<int>(i)).fit.plane;
      original_moments_[i] = graph_.node(static_cast<int>(i)).moments;
    }
    oriented_ = options.oriented_normals;
    if (oriented_ && graph_.inconsistent_share() > 0.05) {
      oriented_ = false;
      AddWarning(
          "merge: the faces of the mesh are not consistently oriented (" +
          std::to_string(100 * graph_.inconsistent_share()) +
          " % of the edges); opposite normals count as equal");
    }
    report_.oriented = oriented_;
  }

  void MergeAll() {
    for (size_t i = 0; i < graph_.size(); ++i) {
      for (const auto& [j, edges] : graph_.node(static_cast<int>(i)).borders) {
        if (static_cast<int>(i) < j) Queue(static_cast<int>(i), j);
      }
    }
    while (!queue_.empty()) {
      const Candidate c = queue_.top();
      queue_.pop();
      if (!IsCurrent(c) || !MayMerge(c.i, c.j)) continue;
      graph_.Unite(c.i, c.j);
      ++report_.merges;
      for (const auto& [other, edges] : graph_.node(c.i).borders) {
        Queue(std::min(c.i, other), std::max(c.i, other));
      }
    }
  }

  // Smallest first, so that islands in islands go too.
  void AbsorbIslands() {
    std::vector<int> order(graph_.size());
    std::iota(order.begin(), order.end(), 0);
    std::vector<double> area(graph_.size());
    for (int i : order) area[i] = graph_.node(i).fit.area;
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
      return area[a] < area[b];
    });
    for (int i : order) {
      const int sea = SeaAround(i);
      if (sea < 0) continue;
      graph_.Unite(sea, i);
      ++report_.islands;
    }
  }

  // The plane of every original cluster, numbered by decreasing area.
  std::vector<int> PlaneOfCluster() const {
    std::vector<int> order;
    for (size_t i = 0; i < graph_.size(); ++i) {
      if (graph_.node(static_cast<int>(i)).alive) {
        order.push_back(static_cast<int>(i));
      }
    }
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
      return graph_.node(a).fit.area > graph_.node(b).fit.area;
    });
    std::vector<int> plane(graph_.size());
    for (size_t id = 0; id < order.size(); ++id) {
      for (int member : graph_.node(order[id]).members) {
        plane[member] = static_cast<int>(id);
      }
    }
    return plane;
  }

 private:
  void Queue(int i, int j) {
    const PlaneNode& a = graph_.node(i);
    const PlaneNode& b = graph_.node(j);
    const double growth =
        ClusterEnergy(options_.energy, Union(a.moments, b.moments)) -
        ClusterEnergy(options_.energy, a.moments) -
        ClusterEnergy(options_.energy, b.moments);
    const double area = std::min(a.fit.area, b.fit.area);
    queue_.push({growth / std::max(area, 1e-12), i, j, a.version, b.version});
  }

  bool IsCurrent(const Candidate& c) const {
    const PlaneNode& a = graph_.node(c.i);
    const PlaneNode& b = graph_.node(c.j);
    return a.alive && b.alive && a.version == c.version_i &&
           b.version == c.version_j;
  }

  // Cheap tests first.
  bool MayMerge(int i, int j) {
    const PlaneNode& a = graph_.node(i);
    const PlaneNode& b = graph_.node(j);
    if (!NormalsAgree(
            a.fit.plane, b.fit.plane, options_.max_normal_deg, oriented_)) {
      ++report_.failed_normals;
      return false;
    }
    if (!LieSideBySide(a.fit, b.fit, options_.min_sheet_deg)) {
      ++report_.failed_sheet;
      return false;
    }
    if (!UnionIsFlat(i, j)) {
      ++report_.failed_guards;
      return false;
    }
    if (!LieClose(a, b)) {
      ++report_.failed_distance;
      return false;
    }
    return true;
  }

  // Rule 2, both ways.
  bool LieClose(const PlaneNode& a, const PlaneNode& b) {
    return Distance(a, b.fit.plane) < options_.max_distance_m &&
           Distance(b, a.fit.plane) < options_.max_distance_m;
  }

  double Distance(const PlaneNode& node, const Plane& plane) {
    if (distances_ + node.vertices.size() > options_.max_exact_distances) {
      return RmsToPlane(node.moments, plane);
    }
    distances_ += node.vertices.size();
    return MeanDistance(mesh_.vertices, node.vertices, plane);
  }

  // The guards against drift.
  bool UnionIsFlat(int i, int j) const {
    const PlaneCluster fit = graph_.FitUnion(i, j);
    if (options_.max_rms_m > 0 && fit.rms > options_.max_rms_m) return false;
    for (int node : {i, j}) {
      for (int member : graph_.node(node).members) {
        if (!MemberFits(member, fit.plane)) return false;
      }
    }
    return true;
  }

  bool MemberFits(int member, const Plane& plane) const {
    if (options_.max_drift_factor > 0 &&
        !NormalsAgree(original_[member],
                      plane,
                      options_.max_drift_factor * options_.max_normal_deg,
                      oriented_)) {
      return false;
    }
    return options_.max_member_rms_m == 0 ||
           RmsToPlane(original_moments_[member], plane) <=
               options_.max_member_rms_m;
  }

  // The plane that node i is an island in, or -1.
  int SeaAround(int i) const {
    const PlaneNode& island = graph_.node(i);
    const int neighbors = static_cast<int>(island.borders.size());
    if (!island.alive || neighbors < 1 ||
        neighbors > options_.island_max_neighbors) {
      return -1;
    }
    int between = 0, longest = 0, sea = -1;
    for (const auto& [other, edges] : island.borders) {
      between += edges;
      if (edges > longest) {
        longest = edges;
        sea = other;
      }
    }
    const double share = options_.island_border_share;
    if (between < share * (between + island.boundary_edges) ||
        longest < share * between) {
      return -1;
    }
    const PlaneNode& around = graph_.node(sea);
    const double area = island.fit.area;
    const bool small =
        area < options_.island_area_share * around.fit.area ||
        (area < options_.island_area_m2 && area < around.fit.area);
    const bool close = RmsToPlane(island.moments, around.fit.plane) <
                       options_.island_max_rms_m;
    return small && close ? sea : -1;
  }

  const TriMesh& mesh_;
  std::vector<Plane> original_;
  std::vector<SurfaceMoments> original_moments_;
  const MergeOptions& options_;
  MergeReport& report_;
  PlaneGraph graph_;
  bool oriented_ = true;
  size_t distances_ = 0;  // vertices that rule 2 has visited
  std::priority_queue<Candidate> queue_;
};

}  // namespace

bool NormalsAgree(const Plane& a,
                  const Plane& b,
                  double max_normal_deg,
                  bool oriented) {
  double cosine = a.normal.dot(b.normal);
  if (!oriented) cosine = std::abs(cosine);
  return cosine > std::cos(std::min(180.0, max_normal_deg) * kDegree);
}

double MeanDistance(const std::vector<Eigen::Vector3d>& positions,
                    const std::vector<int>& vertices,
                    const Plane& plane) {
  if (vertices.empty()) return 0;
  double sum = 0;
  for (int v : vertices) sum += std::abs(plane.SignedDistance(positions[v]));
  return sum / static_cast<double>(vertices.size());
}

bool LieSideBySide(const PlaneCluster& a,
                   const PlaneCluster& b,
                   double min_sheet_deg) {
  const Eigen::Vector3d r = a.centroid - b.centroid;
  const double length = r.norm();
  if (!(length > 0)) return false;
  const double limit = std::cos(min_sheet_deg * kDegree) * length;
  return std::abs(r.dot(a.plane.normal)) < limit &&
         std::abs(r.dot(b.plane.normal)) < limit;
}

PlanarPartition MergePlanes(const TriMesh& mesh,
                            const PlanarPartition& partition,
                            const MergeOptions& options,
                            MergeReport* report) {
  CheckOptions(options);
  MergeReport unused;
  if (!report) report = &unused;
  *report = MergeReport();
  PlaneMerger merger(mesh, partition, options, report);
  if (options.merge_planes) merger.MergeAll();
  if (options.absorb_islands) merger.AbsorbIslands();
  const std::vector<int> plane = merger.PlaneOfCluster();
  PlanarPartition merged;
  merged.face_cluster.resize(mesh.NumFaces());
  for (size_t f = 0; f < mesh.NumFaces(); ++f) {
    merged.face_cluster[f] = plane[partition.face_cluster[f]];
  }
  RefitClusters(mesh, &merged);
  report->rms_m = PartitionRms(mesh, merged);
  return merged;
}

}  // namespace facet
