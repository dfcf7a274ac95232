// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Errors of recovered planes against known ones (method, Sec. 11.4). A plane of
// the model belongs to the true plane that most of its surface lies on: points
// spread over the labelled faces by area look for the nearest true face.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "geometry/plane.h"
#include "mesh/tri_mesh.h"

namespace facet {

struct NumberedPlane {
  int id = 0;
  Plane plane;
};

// Planes of a JSON file: an array, or an object with an array "planes", of
// objects {"id", "normal": [3], "offset"} with n.x + offset = 0. With
// `initial`, those of the member "initial" of each object ({"normal",
// "offset"}); empty if any of them lacks it. Normals are normalised. Throws
// InputError naming the file.
std::vector<NumberedPlane> ReadPlanes(const std::string& path,
                                      bool initial = false);

struct LabelledMesh {
  const TriMesh* mesh;
  const std::vector<int>* face_plane;  // id of each face's plane, -1 = none
};

struct PlaneMetricsOptions {
  size_t num_points = 200000;
  uint64_t seed = 0;
  double max_distance_m = 0.05;  // beyond, a point matches nothing
  double max_angle_deg = 45;     // between the two faces' normals, unsigned
};

// One matched plane of the model.
struct PlaneError {
  int id = 0, true_id = 0;
  double area = 0;       // of the model's plane [m^2]
  double overlap = 0;    // share of its points that lie on the true plane
  double angle_deg = 0;  // between the normals, unsigned
  // Distance to the true plane of the centre of the model's faces, projected
  // onto the recovered plane [m].
  double offset_m = 0;
};

struct PlaneMetrics {
  std::vector<PlaneError> planes;  // ascending id
  size_t unmatched = 0;            // mostly on curved things, or off the truth
  double matched_share = 0;        // of the labelled area
  // Area-weighted over the matched planes; NaN without any.
  double mean_angle_deg = 0, median_angle_deg = 0;
  double mean_offset_m = 0, median_offset_m = 0;
};

// Which true plane a plane of the model lies on, by the surfaces alone.
struct PlaneMatch {
  int id = 0;
  int true_id = -1;                                  // -1 = none
  double area = 0, overlap = 0;                      // as in PlaneError
  Eigen::Vector3d center = Eigen::Vector3d::Zero();  // of the model's faces
};

// All planes with faces in the model, by ascending id. Throws InputError when
// labels are missing or do not fit the mesh.
std::vector<PlaneMatch> MatchPlanes(
    const LabelledMesh& model,
    const std::vector<NumberedPlane>& true_planes,
    const LabelledMesh& true_mesh,
    const PlaneMetricsOptions& options);

// Errors of `planes` given the matches of their surfaces: one matching serves
// the planes of every state of a run.
PlaneMetrics MeasurePlanes(const std::vector<NumberedPlane>& planes,
                           const std::vector<PlaneMatch>& matches,
                           const std::vector<NumberedPlane>& true_planes);

// Both in one.
PlaneMetrics ComparePlanes(const std::vector<NumberedPlane>& planes,
                           const LabelledMesh& model,
                           const std::vector<NumberedPlane>& true_planes,
                           const LabelledMesh& true_mesh,
                           const PlaneMetricsOptions& options);

}  // namespace facet
