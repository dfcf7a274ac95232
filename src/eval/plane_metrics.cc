// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "eval/plane_metrics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include "eval/mesh_distance.h"
#include "util/atomic_file.h"
#include "util/errors.h"
#include "util/parallel_for.h"

namespace facet {
namespace {

constexpr double kRadToDeg = 57.29577951308232;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Plane ParsePlane(const nlohmann::json& entry) {
  const std::vector<double> n = entry.at("normal").get<std::vector<double>>();
  Plane plane;
  if (n.size() != 3) throw std::invalid_argument("a normal has 3 numbers");
  plane.normal = Eigen::Vector3d(n[0], n[1], n[2]);
  plane.offset = entry.at("offset").get<double>();
  const double length = plane.normal.norm();
  if (!(length > 1e-9) || !std::isfinite(plane.offset)) {
    throw std::invalid_argument("a normal is zero or an offset not finite");
  }
  plane.normal /= length;
  plane.offset /= length;
  return plane;
}

std::map<int, Plane> ById(const std::vector<NumberedPlane>& planes) {
  std::map<int, Plane> by_id;
  for (const NumberedPlane& p : planes) by_id[p.id] = p.plane;
  return by_id;
}

void CheckLabels(const LabelledMesh& labelled, const char* which) {
  if (labelled.face_plane->size() != labelled.mesh->NumFaces()) {
    throw InputError(std::string(which) +
                     " has no plane_id for each of its faces: planes cannot "
                     "be matched");
  }
}

// True plane under each sample, -1 = none.
std::vector<int> LabelsUnder(const std::vector<SurfaceSample>& samples,
                             const TriMesh& mesh,
                             const LabelledMesh& truth,
                             const PlaneMetricsOptions& options) {
  const RayScene scene(*truth.mesh);
  const double min_cos = std::cos(options.max_angle_deg / kRadToDeg);
  std::vector<int> labels(samples.size(), -1);
  ParallelFor(
      0,
      samples.size(),
      [&](size_t i) {
        const NearestHit hit =
            scene.NearestPoint(samples[i].point, options.max_distance_m);
        if (hit.face < 0) return;
        const Eigen::Vector3d a = mesh.FaceCross(samples[i].face).normalized();
        const Eigen::Vector3d b = truth.mesh->FaceCross(hit.face).normalized();
        if (std::abs(a.dot(b)) >= min_cos) {
          labels[i] = (*truth.face_plane)[hit.face];
        }
      },
      1024);
  return labels;
}

struct Patch {
  double area = 0;
  Eigen::Vector3d weighted_center = Eigen::Vector3d::Zero();
  size_t points = 0;
  std::map<int, size_t> votes;  // true id -> points
};

std::map<int, Patch> CollectPatches(const LabelledMesh& model,
                                    const LabelledMesh& truth,
                                    const PlaneMetricsOptions& options) {
  std::map<int, Patch> patches;
  for (size_t f = 0; f < model.mesh->NumFaces(); ++f) {
    const int id = (*model.face_plane)[f];
    if (id < 0) continue;
    const double area = model.mesh->FaceArea(f);
    Patch& patch = patches[id];
    patch.area += area;
    patch.weighted_center += area * model.mesh->FaceCentroid(f);
  }
  const auto samples =
      SampleSurface(*model.mesh, options.num_points, options.seed);
  const std::vector<int> labels =
      LabelsUnder(samples, *model.mesh, truth, options);
  for (size_t i = 0; i < samples.size(); ++i) {
    const int id = (*model.face_plane)[samples[i].face];
    if (id < 0) continue;
    Patch& patch = patches[id];
    ++patch.points;
    if (labels[i] >= 0) ++patch.votes[labels[i]];
  }
  return patches;
}

// The value at which half of the weight is reached.
double WeightedMedian(std::vector<std::pair<double, double>> value_weight) {
  if (value_weight.empty()) return kNan;
  std::sort(value_weight.begin(), value_weight.end());
  double total = 0, sum = 0;
  for (const auto& [value, weight] : value_weight) total += weight;
  for (const auto& [value, weight] : value_weight) {
    sum += weight;
    if (sum >= 0.5 * total) return value;
  }
  return value_weight.back().first;
}

void SummarisePlanes(PlaneMetrics* metrics) {
  double area = 0, angle = 0, offset = 0;
  std::vector<std::pair<double, double>> angles, offsets;
  for (const PlaneError& e : metrics->planes) {
    area += e.area;
    angle += e.area * e.angle_deg;
    offset += e.area * e.offset_m;
    angles.emplace_back(e.angle_deg, e.area);
    offsets.emplace_back(e.offset_m, e.area);
  }
  metrics->mean_angle_deg = area > 0 ? angle / area : kNan;
  metrics->mean_offset_m = area > 0 ? offset / area : kNan;
  metrics->median_angle_deg = WeightedMedian(angles);
  metrics->median_offset_m = WeightedMedian(offsets);
}

}  // namespace

std::vector<NumberedPlane> ReadPlanes(const std::string& path, bool initial) {
  const std::string text = ReadFile(path);
  std::vector<NumberedPlane> planes;
  try {
    const nlohmann::json file = nlohmann::json::parse(text);
    for (const nlohmann::json& entry :
         file.is_array() ? file : file.at("planes")) {
      if (initial && !entry.contains("initial")) return {};
      planes.push_back({entry.at("id").get<int>(),
                        ParsePlane(initial ? entry.at("initial") : entry)});
    }
  } catch (const std::exception& e) {
    throw InputError(
        "'" + path +
        "' is no list of planes with id, normal and offset: " + e.what());
  }
  if (planes.empty()) throw InputError("'" + path + "' holds no plane");
  return planes;
}

std::vector<PlaneMatch> MatchPlanes(
    const LabelledMesh& model,
    const std::vector<NumberedPlane>& true_planes,
    const LabelledMesh& true_mesh,
    const PlaneMetricsOptions& options) {
  CheckLabels(model, "the model");
  CheckLabels(true_mesh, "the true mesh");
  const std::map<int, Plane> truth_of = ById(true_planes);
  std::vector<PlaneMatch> matches;
  for (const auto& [id, patch] : CollectPatches(model, true_mesh, options)) {
    int best = -1;
    size_t best_votes = 0;
    for (const auto& [true_id, votes] : patch.votes) {
      if (votes > best_votes && truth_of.count(true_id) > 0) {
        best = true_id;
        best_votes = votes;
      }
    }
    PlaneMatch match;
    match.id = id;
    match.area = patch.area;
    match.center = patch.weighted_center / patch.area;
    // Less than half of it on one true plane: it is not that plane.
    if (2 * best_votes > patch.points) {
      match.true_id = best;
      match.overlap =
          static_cast<double>(best_votes) / static_cast<double>(patch.points);
    }
    matches.push_back(match);
  }
  return matches;
}

PlaneMetrics MeasurePlanes(const std::vector<NumberedPlane>& planes,
                           const std::vector<PlaneMatch>& matches,
                           const std::vector<NumberedPlane>& true_planes) {
  const std::map<int, Plane> plane_of = ById(planes);
  const std::map<int, Plane> truth_of = ById(true_planes);
  PlaneMetrics metrics;
  double labelled_area = 0, matched_area = 0;
  for (const PlaneMatch& match : matches) {
    labelled_area += match.area;
    const auto plane = plane_of.find(match.id);
    if (plane == plane_of.end() || match.true_id < 0) {
      ++metrics.unmatched;
      continue;
    }
    matched_area += match.area;
    const Plane& estimate = plane->second;
    const Plane& truth = truth_of.at(match.true_id);
    PlaneError error;
    error.id = match.id;
    error.true_id = match.true_id;
    error.area = match.area;
    error.overlap = match.overlap;
    const double sine = estimate.normal.cross(truth.normal).norm();
    const double cosine = std::abs(estimate.normal.dot(truth.normal));
    error.angle_deg = std::atan2(sine, cosine) * kRadToDeg;
    error.offset_m =
        std::abs(truth.SignedDistance(estimate.Project(match.center)));
    metrics.planes.push_back(error);
  }
  metrics.matched_share = labelled_area > 0 ? matched_area / labelled_area : 0;
  SummarisePlanes(&metrics);
  return metrics;
}

PlaneMetrics ComparePlanes(const std::vector<NumberedPlane>& planes,
                           const LabelledMesh& model,
                           const std::vector<NumberedPlane>& true_planes,
                           const LabelledMesh& true_mesh,
                           const PlaneMetricsOptions& options) {
  return MeasurePlanes(
      planes, MatchPlanes(model, true_planes, true_mesh, options), true_planes);
}

}  // namespace facet
