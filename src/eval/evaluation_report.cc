// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "eval/evaluation_report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>

namespace facet {
namespace {

using nlohmann::json;

json Number(double value) {
  return std::isfinite(value) ? json(value) : json();
}

json ToJson(const ViewMetrics& m) {
  return {{"psnr", Number(m.psnr)},
          {"psnr_affine", Number(m.psnr_affine)},
          {"psnr_strict", Number(m.psnr_strict)},
          {"psnr_strict_affine", Number(m.psnr_strict_affine)},
          {"ssim", Number(m.ssim)},
          {"ssim_affine", Number(m.ssim_affine)},
          {"gradient_ncc", Number(m.gradient_ncc)},
          {"gradient_energy", Number(m.gradient_energy)},
          {"coverage", Number(m.coverage)},
          {"depth_agreement", Number(m.agreement)},
          {"depth_error_mean_mm", Number(1000 * m.depth_error_mean)},
          {"depth_error_median_mm", Number(1000 * m.depth_error_median)},
          {"depth_pixels", m.depth_pixels},
          {"mask_pixels", m.mask_pixels}};
}

json ToJson(const ModelEvaluation& e) {
  json frames = json::array();
  for (const FrameEvaluation& f : e.frames) {
    json frame = {{"number", f.number}, {"valid", f.valid}};
    if (f.valid) {
      frame["given"] = ToJson(f.given);
      frame["aligned"] = ToJson(f.aligned);
      frame["alignment"] = {{"accepted", f.alignment.accepted},
                            {"shift_mm", Number(1000 * f.alignment.shift_m)},
                            {"angle_deg", Number(f.alignment.angle_deg)},
                            {"iterations", f.alignment.iterations}};
    }
    frames.push_back(frame);
  }
  return {{"psnr", Number(e.given.psnr)},
          {"psnr_affine", Number(e.given.psnr_affine)},
          {"psnr_aligned", Number(e.aligned.psnr_affine)},
          {"psnr_strict", Number(e.given.psnr_strict)},
          {"ssim", Number(e.given.ssim)},
          {"ssim_aligned", Number(e.aligned.ssim_affine)},
          {"gradient_ncc", Number(e.aligned.gradient_ncc)},
          {"gradient_energy", Number(e.aligned.gradient_energy)},
          {"gradient_ncc_given", Number(e.given.gradient_ncc)},
          {"gradient_energy_given", Number(e.given.gradient_energy)},
          {"coverage", Number(e.given.coverage)},
          {"given", ToJson(e.given)},
          {"aligned", ToJson(e.aligned)},
          {"valid_frames", e.valid_frames},
          {"rejected_alignments", e.rejected_alignments},
          {"mean_shift_mm", Number(1000 * e.mean_shift_m)},
          {"mean_angle_deg", Number(e.mean_angle_deg)},
          {"frames", frames}};
}

json ToJson(const MeshChecks& c) {
  return {{"non_manifold_edges", c.non_manifold_edges},
          {"non_manifold_vertices", c.non_manifold_vertices},
          {"duplicate_faces", c.duplicate_faces},
          {"degenerate_faces", c.degenerate_faces},
          {"isolated_vertices", c.isolated_vertices},
          {"boundary_edges", c.boundary_edges},
          {"boundary_loops", c.boundary_loops},
          {"components", c.components},
          {"euler", c.euler}};
}

json ToJson(const DistanceStats& s) {
  return {{"mean_mm", 1000 * s.mean},
          {"median_mm", 1000 * s.median},
          {"rms_mm", 1000 * s.rms},
          {"p90_mm", 1000 * s.p90},
          {"max_mm", 1000 * s.max}};
}

json ToJson(const MeshDistance& d) {
  json f_scores = json::array();
  for (size_t k = 0; k < kFScoreThresholds.size(); ++k) {
    f_scores.push_back({{"threshold_mm", 1000 * kFScoreThresholds[k]},
                        {"precision", d.precision[k]},
                        {"recall", d.recall[k]},
                        {"f_score", d.f_score[k]}});
  }
  return {{"accuracy", ToJson(d.accuracy)},
          {"completeness", ToJson(d.completeness)},
          {"f_scores", f_scores}};
}

json ToJson(const ErrorSummary& s, double scale) {
  return {{"rmse", Number(scale * s.rmse)},
          {"mean", Number(scale * s.mean)},
          {"median", Number(scale * s.median)},
          {"max", Number(scale * s.max)},
          {"count", s.count}};
}

json ToJson(const TrajectoryError& e) {
  return {{"frames", e.matched},
          {"ate_mm", ToJson(e.ate, 1000)},
          {"absolute_mm", ToJson(e.absolute, 1000)},
          {"rotation_deg", ToJson(e.rotation, 1)},
          {"rpe_frame_mm", ToJson(e.frame.translation, 1000)},
          {"rpe_frame_deg", ToJson(e.frame.rotation, 1)},
          {"rpe_second_mm", ToJson(e.second.translation, 1000)},
          {"rpe_second_deg", ToJson(e.second.rotation, 1)},
          {"slide", {{"mm", e.slide.mm}, {"deg", e.slide.deg}}}};
}

json ToJson(const PlaneMetrics& m) {
  json planes = json::array();
  for (const PlaneError& e : m.planes) {
    planes.push_back({{"id", e.id},
                      {"true_id", e.true_id},
                      {"area", e.area},
                      {"overlap", e.overlap},
                      {"angle_deg", e.angle_deg},
                      {"offset_mm", 1000 * e.offset_m}});
  }
  return {{"matched", m.planes.size()},
          {"unmatched", m.unmatched},
          {"matched_share", m.matched_share},
          {"angle_deg",
           {{"mean", Number(m.mean_angle_deg)},
            {"median", Number(m.median_angle_deg)}}},
          {"offset_mm",
           {{"mean", Number(1000 * m.mean_offset_m)},
            {"median", Number(1000 * m.median_offset_m)}}},
          {"planes", planes}};
}

// A table whose columns are as wide as their heads, numbers to the right.
class Table {
 public:
  explicit Table(const std::vector<std::string>& heads) : heads_(heads) {
    text_ = Pad("", kNameWidth);
    for (const std::string& head : heads_) text_ += "  " + head;
    text_ += "\n";
  }
  void BeginRow(std::string name) {
    // The end of a path says more than its beginning.
    if (name.size() > kNameWidth) {
      name = "..." + name.substr(name.size() - kNameWidth + 3);
    }
    text_ += name + std::string(kNameWidth - name.size(), ' ');
    column_ = 0;
  }
  void Cell(double value, int digits) {
    char buffer[64] = "-";
    if (std::isfinite(value)) {
      std::snprintf(buffer, sizeof(buffer), "%.*f", digits, value);
    }
    text_ += "  " + Pad(buffer, heads_[column_++].size());
  }
  void EndRow() { text_ += "\n"; }
  const std::string& text() const { return text_; }

 private:
  static constexpr size_t kNameWidth = 30;
  static std::string Pad(const std::string& s, size_t width) {
    return std::string(width - std::min(width, s.size()), ' ') + s;
  }
  std::vector<std::string> heads_;
  std::string text_;
  size_t column_ = 0;
};

std::string PhotometricTable(const std::vector<ModelReport>& reports) {
  Table table({"frames",
               "  psnr",
               "affine",
               "aligned",
               "strict",
               " ssim",
               "ssim-al",
               "g-ncc",
               "g-energy",
               "ncc-given",
               "energy-given",
               "cover",
               "agree",
               "depth mm",
               "shift mm",
               "rejected"});
  for (const ModelReport& r : reports) {
    if (!r.photometric) continue;
    const ModelEvaluation& e = *r.photometric;
    table.BeginRow(r.model);
    table.Cell(static_cast<double>(e.valid_frames), 0);
    table.Cell(e.given.psnr, 2);
    table.Cell(e.given.psnr_affine, 2);
    table.Cell(e.aligned.psnr_affine, 2);
    table.Cell(e.given.psnr_strict, 2);
    table.Cell(e.given.ssim, 3);
    table.Cell(e.aligned.ssim_affine, 3);
    table.Cell(e.aligned.gradient_ncc, 3);
    table.Cell(e.aligned.gradient_energy, 3);
    table.Cell(e.given.gradient_ncc, 3);
    table.Cell(e.given.gradient_energy, 3);
    table.Cell(e.given.coverage, 3);
    table.Cell(e.given.agreement, 3);
    table.Cell(1000 * e.given.depth_error_mean, 1);
    table.Cell(1000 * e.mean_shift_m, 1);
    table.Cell(static_cast<double>(e.rejected_alignments), 0);
    table.EndRow();
  }
  return "\nPhotos: means over frames; affine after gain and bias; aligned, "
         "ssim-al, g-* also\nafter pose refinement; strict over all "
         "valid-depth pixels\n" +
         table.text();
}

std::string MeshTable(const std::vector<ModelReport>& reports) {
  Table table({"  faces",
               "vertices",
               "non-manifold",
               "duplicate",
               "degenerate",
               "components"});
  for (const ModelReport& r : reports) {
    table.BeginRow(r.model);
    table.Cell(static_cast<double>(r.faces), 0);
    table.Cell(static_cast<double>(r.vertices), 0);
    table.Cell(r.checks.non_manifold_edges, 0);
    table.Cell(r.checks.duplicate_faces, 0);
    table.Cell(r.checks.degenerate_faces, 0);
    table.Cell(r.checks.components, 0);
    table.EndRow();
  }
  return "\nMesh\n" + table.text();
}

std::string DistanceTable(const std::vector<ModelReport>& reports) {
  Table table({" mean",
               "median",
               "  rms",
               " 90 %",
               "   max",
               "F 10 mm",
               "F 20 mm",
               "F 50 mm"});
  for (const ModelReport& r : reports) {
    if (!r.distance) continue;
    for (const bool accuracy : {true, false}) {
      const DistanceStats& s =
          accuracy ? r.distance->accuracy : r.distance->completeness;
      table.BeginRow(accuracy ? r.model : "  back");
      for (const double v : {s.mean, s.median, s.rms, s.p90, s.max}) {
        table.Cell(1000 * v, 2);
      }
      for (const double f : r.distance->f_score) {
        if (accuracy) table.Cell(f, 4);
      }
      table.EndRow();
    }
  }
  return "\nDistance to the reference mesh and back [mm]\n" + table.text();
}

std::string TrajectoryTable(const std::vector<ModelReport>& reports) {
  Table table({"frames",
               "ate rmse",
               "median",
               "   max",
               "rpe frame mm",
               "  deg",
               "rpe 1 s mm",
               "  deg",
               "slide mm",
               "   deg"});
  for (const ModelReport& r : reports) {
    const auto add = [&](const std::string& name, const TrajectoryError& e) {
      table.BeginRow(name);
      table.Cell(static_cast<double>(e.matched), 0);
      table.Cell(1000 * e.ate.rmse, 2);
      table.Cell(1000 * e.ate.median, 2);
      table.Cell(1000 * e.ate.max, 2);
      table.Cell(1000 * e.frame.translation.rmse, 2);
      table.Cell(e.frame.rotation.rmse, 3);
      table.Cell(1000 * e.second.translation.rmse, 2);
      table.Cell(e.second.rotation.rmse, 3);
      table.Cell(e.slide.mm, 2);
      table.Cell(e.slide.deg, 3);
      table.EndRow();
    };
    if (r.trajectory) add(r.model, *r.trajectory);
    if (r.input_trajectory) add("  input poses", *r.input_trajectory);
  }
  return "\nPoses against the truth [mm]\n" + table.text();
}

std::string PlaneTable(const std::vector<ModelReport>& reports) {
  Table table({"matched",
               "unmatched",
               "area share",
               "angle mean",
               "median deg",
               "offset mean",
               "median mm"});
  for (const ModelReport& r : reports) {
    const auto add = [&](const std::string& name, const PlaneMetrics& m) {
      table.BeginRow(name);
      table.Cell(static_cast<double>(m.planes.size()), 0);
      table.Cell(static_cast<double>(m.unmatched), 0);
      table.Cell(m.matched_share, 3);
      table.Cell(m.mean_angle_deg, 3);
      table.Cell(m.median_angle_deg, 3);
      table.Cell(1000 * m.mean_offset_m, 2);
      table.Cell(1000 * m.median_offset_m, 2);
      table.EndRow();
    };
    if (r.planes) add(r.model, *r.planes);
    if (r.initial_planes) add("  initial planes", *r.initial_planes);
  }
  return "\nPlanes against the truth, weighted by area\n" + table.text();
}

}  // namespace

nlohmann::json ToJson(const ModelReport& r) {
  json result = {{"model", r.model},
                 {"vertices", r.vertices},
                 {"faces", r.faces},
                 {"textured", r.textured},
                 {"mesh_checks", ToJson(r.checks)}};
  if (!r.pose_source.empty()) result["pose_source"] = r.pose_source;
  if (r.photometric) result["photometric"] = ToJson(*r.photometric);
  if (r.distance) result["distance"] = ToJson(*r.distance);
  if (r.trajectory) result["trajectory"] = ToJson(*r.trajectory);
  if (r.input_trajectory) {
    result["input_trajectory"] = ToJson(*r.input_trajectory);
  }
  if (r.planes) result["planes"] = ToJson(*r.planes);
  if (r.initial_planes) result["initial_planes"] = ToJson(*r.initial_planes);
  for (const TraceErrors& e : r.trace) {
    result["trace"].push_back(
        {{"ate_mm", Number(1000 * e.ate_m)},
         {"rotation_deg", Number(e.rotation_deg)},
         {"plane_angle_deg", Number(e.plane_angle_deg)},
         {"plane_offset_mm", Number(1000 * e.plane_offset_m)}});
  }
  return result;
}

std::string FormatTables(const std::vector<ModelReport>& reports) {
  const auto any = [&](const std::function<bool(const ModelReport&)>& has) {
    return std::any_of(reports.begin(), reports.end(), has);
  };
  std::string text = MeshTable(reports);
  if (any([](const auto& r) { return r.photometric.has_value(); })) {
    text += PhotometricTable(reports);
  }
  if (any([](const auto& r) { return r.distance.has_value(); })) {
    text += DistanceTable(reports);
  }
  if (any([](const auto& r) { return r.trajectory.has_value(); })) {
    text += TrajectoryTable(reports);
  }
  if (any([](const auto& r) { return r.planes.has_value(); })) {
    text += PlaneTable(reports);
  }
  return text;
}

}  // namespace facet
