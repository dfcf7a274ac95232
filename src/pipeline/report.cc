// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "pipeline/report.h"

#include <ceres/version.h>
#include <sys/utsname.h>

#include <Eigen/Core>
#include <algorithm>
#include <opencv2/core/version.hpp>
#include <thread>

#include "costs/photo_kernel.h"
#include "util/parallel_for.h"

namespace facet {

using nlohmann::json;

json ToJson(const EnergyTerms& t) {
  json terms = json::object();
  for (const NamedEnergy& term : t.e_terms) terms[term.name] = term.value;
  return {{"E_c", t.e_c},
          {"E_p", t.e_p},
          {"E_s", t.e_s},
          {"E_tex", t.e_tex},
          {"E_prior", t.e_prior},
          {"E_depth", t.e_depth},
          {"terms", terms},
          {"rms_intensity", t.RmsIntensity()},
          {"rms_grey", t.rms_grey},
          {"observations", t.observations},
          {"clamped", t.clamped},
          {"clamped_share", t.ClampedShare()},
          {"behind", t.behind},
          {"lost", t.lost}};
}

json SimplifyStageReport(const SimplifyReport& r) {
  return {{"faces", r.faces_after},
          {"collapses", r.collapses},
          {"max_error_m", r.max_error_m},
          {"flipped_area_share_before", r.flipped_before.area_share},
          {"flipped_area_share", r.flipped_after.area_share},
          {"border_edges_before", r.border_edges_before},
          {"border_edges_after", r.border_edges_after}};
}

json KeyframeReport(const RgbdSequence& sequence,
                    const std::vector<int>& keyframes,
                    const KeyframeOptions& options) {
  size_t usable = 0, held_out = 0;
  for (const Frame& frame : sequence.frames()) {
    usable += frame.usable ? 1 : 0;
    held_out += frame.usable && IsHeldOut(frame.number, options) ? 1 : 0;
  }
  return {{"frames", sequence.frames().size()},
          {"usable", usable},
          {"held_out", held_out},
          {"keyframes", keyframes.size()},
          {"numbers", sequence.Numbers(keyframes)}};
}

namespace {

json ExposureReport(const ExposureCalibration& e) {
  if (e.samples == 0) return {{"samples", 0}};
  return {{"samples", e.samples},
          {"rms_grey_before", e.rms_before},
          {"rms_grey_after", e.rms_after},
          {"min_grey", e.min_grey},
          {"max_grey", e.max_grey}};
}

}  // namespace

json PhotometricReport(const PhotometricResult& result,
                       const RigidMotion& slide) {
  const VisibilityCounts& v = result.visibility;
  size_t rejected = 0;
  for (const TraceRow& row : result.trace.rows) {
    rejected += row.phase.accepted ? 0 : 1;
  }
  return {{"texels", result.texels},
          {"texels_observed", result.texels_observed},
          {"texel_stride", result.stride},
          {"observations", result.initial.observations},
          {"observation_fingerprint", result.observation_fingerprint},
          {"lambda1", result.lambda1},
          {"exposure", ExposureReport(result.exposure)},
          {"energy",
           {{"initial", ToJson(result.initial)},
            {"final", ToJson(result.final_terms)}}},
          {"slide", {{"mm", slide.mm}, {"deg", slide.deg}}},
          {"phases", {{"run", result.trace.rows.size()}, {"undone", rejected}}},
          {"visibility",
           {{"candidates", v.candidates},
            {"behind_or_far", v.behind_or_far},
            {"outside_image", v.outside_image},
            {"grazing", v.grazing},
            {"depth_missing", v.depth_missing},
            {"depth_edge", v.depth_edge},
            {"depth_disagrees", v.depth_disagrees},
            {"mesh_edge", v.mesh_edge},
            {"occluded", v.occluded},
            {"too_few_views", v.too_few_views},
            {"used", v.used}}}};
}

json GeometryReport(const GeometrySummary& s) {
  return {{"data_before", s.data_before},
          {"data_after", s.data_after},
          {"smooth_before", s.smooth_before},
          {"smooth_after", s.smooth_after},
          {"plane_rms_before_m", s.plane_rms_before},
          {"plane_rms_after_m", s.plane_rms_after},
          {"mean_move_m", s.mean_move_m},
          {"max_move_m", s.max_move_m},
          {"clamped_vertices", s.clamped_vertices},
          {"restored_vertices", s.restored_vertices},
          {"flipped_faces_before", s.flipped_faces_before},
          {"flipped_faces", s.flipped_faces},
          {"degenerate_faces", s.degenerate_faces}};
}

std::vector<std::string> WithoutRepetitions(
    const std::vector<std::string>& warnings) {
  std::vector<std::string> once;
  for (const std::string& w : warnings) {
    if (std::find(once.begin(), once.end(), w) == once.end()) {
      once.push_back(w);
    }
  }
  return once;
}

void AddEnvironment(json* report) {
  utsname system{};
  uname(&system);
  (*report)["versions"] = {{"facet", FACET_VERSION},
                           {"ceres", CERES_VERSION_STRING},
                           {"eigen",
                            std::to_string(EIGEN_WORLD_VERSION) + "." +
                                std::to_string(EIGEN_MAJOR_VERSION) + "." +
                                std::to_string(EIGEN_MINOR_VERSION)},
                           {"opencv", CV_VERSION},
                           {"compiler", __VERSION__},
                           {"kernel", GetPhotoKernel().name}};
  (*report)["machine"] = {
      {"system", std::string(system.sysname) + " " + system.release},
      {"architecture", system.machine},
      {"cores", std::thread::hardware_concurrency()},
      {"threads", NumThreads()}};
}

}  // namespace facet
