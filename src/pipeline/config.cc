// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "pipeline/config.h"

#include <filesystem>
#include <utility>

namespace facet {
namespace {

using nlohmann::json;

// An input that was replaced since is noticed by its size.
json InputStamp(const std::string& path) {
  std::error_code ignored;
  const auto size = std::filesystem::is_regular_file(path, ignored)
                        ? std::filesystem::file_size(path, ignored)
                        : 0;
  return {{"path", path}, {"bytes", size}};
}

json PartitionSettings(const ReconstructOptions& o) {
  return {{"mesh", InputStamp(o.mesh_path)},
          {"weld_tolerance_m", o.clean.weld_tolerance_m},
          {"min_component_faces", o.clean.min_component_faces},
          {"target_clusters", o.partition.target_clusters},
          {"max_rms_m", o.partition.max_rms_m},
          {"energy", static_cast<int>(o.partition.energy.kind)},
          {"alpha", o.partition.energy.alpha},
          {"tau", o.partition.energy.tau},
          {"swap_borders", o.partition.swap_borders},
          {"merge_planes", o.merge.merge_planes},
          {"max_normal_deg", o.merge.max_normal_deg},
          {"max_distance_m", o.merge.max_distance_m},
          {"min_sheet_deg", o.merge.min_sheet_deg},
          {"merge_max_rms_m", o.merge.max_rms_m},
          {"max_member_rms_m", o.merge.max_member_rms_m},
          {"max_drift_factor", o.merge.max_drift_factor},
          {"absorb_islands", o.merge.absorb_islands}};
}

json SimplifySettings(const ReconstructOptions& o) {
  return {{"stop", static_cast<int>(o.simplify.stop)},
          {"inner_target", o.simplify.inner_target},
          {"border_ratio", o.simplify.border_ratio},
          {"passes", o.simplify.passes},
          {"target_faces", o.simplify.target_faces},
          {"faces_per_m2", o.simplify.faces_per_m2},
          {"sweep_ratio", o.simplify.sweep_ratio},
          {"free_error_m", o.simplify.free_error_m},
          {"max_error_m", o.simplify.max_error_m},
          {"cluster_plane_share", o.simplify.cluster_plane_share},
          {"plane_reach_m", o.simplify.plane_reach_m},
          {"collapse_to_border", o.simplify.collapse_to_border},
          {"keep_mesh_boundary", o.simplify.keep_mesh_boundary}};
}

json KeyframeSettings(const ReconstructOptions& o) {
  return {
      {"sequence", o.sequence_path},
      {"pose_camera", static_cast<int>(o.sequence.pose_camera)},
      {"extrinsic_direction", static_cast<int>(o.sequence.extrinsic_direction)},
      {"min_depth_m", o.sequence.min_depth_m},
      {"max_depth_m", o.sequence.max_depth_m},
      {"window", o.keyframes.window},
      {"holdout_stride", o.keyframes.holdout_stride},
      {"holdout_offset", o.keyframes.holdout_offset}};
}

json PhotometricSettings(const ReconstructOptions& o) {
  const VisibilityOptions& v = o.visibility;
  const PhotometricOptions& p = o.photometric;
  json terms = json::object();
  for (const WeightedTerm& term : p.terms) terms[term.name] = term.weight;
  return {
      {"plane_init", static_cast<int>(o.plane_init)},
      {"texel_size_m", o.atlas.texel_size_m},
      {"stride", p.stride},
      {"max_observations", p.max_observations},
      {"smoothing_sigma_px", p.smoothing_sigma_px},
      {"exposure", p.exposure},
      {"warp_columns", p.warp_columns},
      {"warp_rows", p.warp_rows},
      {"levels", p.levels},
      {"schedule", p.schedule},
      {"stop_relative_decrease", p.stop.relative_decrease},
      {"max_plane_iterations", p.solver.max_plane_iterations},
      {"max_pose_iterations", p.solver.max_pose_iterations},
      {"max_joint_iterations", p.solver.max_joint_iterations},
      {"joint_tolerance", p.solver.joint_tolerance},
      {"joint_hessian_every", p.solver.joint_hessian_every},
      {"active_tolerance", p.solver.active_tolerance},
      {"plane", static_cast<int>(p.formulation.plane)},
      {"manifold", static_cast<int>(p.formulation.manifold)},
      {"sampling", static_cast<int>(p.formulation.sampling)},
      {"loss", static_cast<int>(p.formulation.loss)},
      {"loss_scale", p.formulation.loss_scale},
      {"out_of_image", static_cast<int>(p.formulation.out_of_image)},
      {"channels", static_cast<int>(p.formulation.channels)},
      {"evaluation", static_cast<int>(p.formulation.evaluation)},
      {"fix_first_pose", p.solver.fix_first_pose},
      {"joint_method", static_cast<int>(p.solver.joint_method)},
      {"joint_linear_solver", static_cast<int>(p.solver.joint_linear_solver)},
      {"lambda1_share", p.weights.lambda1_share},
      {"lambda2", p.weights.lambda2},
      {"remove_common_motion", p.solver.remove_common_motion},
      {"pose_prior", p.weights.pose_prior},
      {"prior_rotation_rad", p.weights.prior.rotation_rad},
      {"prior_translation_m", p.weights.prior.translation_m},
      {"depth_weight", p.weights.depth_weight},
      {"terms", terms},
      {"prior_strength", p.weights.prior_strength},
      {"image_margin_px", v.image_margin_px},
      {"test_occlusion", v.test_occlusion},
      {"test_sensor_depth", v.test_sensor_depth},
      {"min_depth_tolerance_m", v.min_depth_tolerance_m},
      {"allow_missing_depth", v.allow_missing_depth},
      {"test_angle", v.test_angle},
      {"max_angle_deg", v.max_angle_deg},
      {"test_depth_edges", v.test_depth_edges},
      {"edge_margin_m", p.edge_margin_m},
      {"test_mesh_edges", v.test_mesh_edges},
      {"occlusion_tolerance_m", v.occlusion_tolerance_m},
      {"min_views", v.min_views}};
}

json GeometrySettings(const ReconstructOptions& o) {
  return {{"lambda3", o.geometry.lambda3},
          {"freedom", static_cast<int>(o.geometry.freedom)},
          {"band_m", o.geometry.band_m},
          {"iterations", o.geometry.iterations},
          {"max_move_m", o.geometry.max_move_m}};
}

json ExportSettings(const ReconstructOptions& o) {
  return {{"page_size", o.atlas.page_size},
          {"gutter_px", o.atlas.gutter_px},
          {"angle_power", o.bake.angle_power},
          {"depth_power", o.bake.depth_power},
          {"sharpness_power", o.bake.sharpness_power},
          {"best_view_power", o.bake.best_view_power},
          {"robust_luma", o.bake.robust_luma},
          {"local_exposure", o.bake.local_exposure},
          {"sampler", static_cast<int>(o.bake.sampler)},
          {"visibility_px", o.bake.visibility_px},
          {"inpaint", o.bake.inpaint}};
}

}  // namespace

json StageSettings(const ReconstructOptions& options, Stage stage) {
  switch (stage) {
    case Stage::kPartition:
      return PartitionSettings(options);
    case Stage::kSimplify:
      return SimplifySettings(options);
    case Stage::kKeyframes:
      return KeyframeSettings(options);
    case Stage::kPhotometric:
      return PhotometricSettings(options);
    case Stage::kGeometry:
      return GeometrySettings(options);
    case Stage::kExport:
      return ExportSettings(options);
  }
  return {};
}

std::string FlagOfSetting(const std::string& setting) {
  static constexpr std::pair<const char*, const char*> kFlags[] = {
      {"target_clusters", "partition_clusters"},
      {"max_rms_m", "partition_max_rms"},
      {"merge_planes", "merge"},
      {"max_normal_deg", "merge_max_normal_deg"},
      {"max_distance_m", "merge_max_distance"},
      {"min_sheet_deg", "merge_min_sheet_deg"},
      {"merge_max_rms_m", "merge_max_rms"},
      {"max_member_rms_m", "merge_max_member_rms"},
      {"max_drift_factor", "merge_max_drift"},
      {"absorb_islands", "merge_islands"},
      {"stop", "simplify_stop"},
      {"inner_target", "simplify_inner_target"},
      {"border_ratio", "simplify_border_ratio"},
      {"passes", "simplify_passes"},
      {"target_faces", "simplify_faces"},
      {"faces_per_m2", "simplify_faces_per_m2"},
      {"cluster_plane_share", "simplify_plane_share"},
      {"plane_reach_m", "simplify_plane_reach"},
      {"sweep_ratio", "simplify_sweep_ratio"},
      {"min_depth_m", "min_depth"},
      {"max_depth_m", "max_depth"},
      {"window", "keyframe_window"},
      {"texel_size_m", "texel_size"},
      {"stride", "texel_stride"},
      {"edge_margin_m", "edge_margin"},
      {"occlusion_tolerance_m", "occlusion_tolerance"},
      {"smoothing_sigma_px", "smoothing"},
      {"stop_relative_decrease", "stop_decrease"},
      {"max_plane_iterations", "plane_iterations"},
      {"max_pose_iterations", "pose_iterations"},
      {"max_joint_iterations", "joint_iterations"},
      {"joint_method", "joint"},
      {"joint_linear_solver", "linear_solver"},
      {"fix_first_pose", "gauge"},
      {"remove_common_motion", "gauge"},
      {"pose_prior", "gauge"},
      {"prior_rotation_rad", "gauge_sigma_deg"},
      {"prior_translation_m", "gauge_sigma_mm"},
      {"prior_strength", "gauge_strength"},
      {"image_margin_px", "image_margin"},
      {"freedom", "geometry_freedom"},
      {"band_m", "geometry_band"},
      {"iterations", "geometry_iterations"}};
  for (const auto& [name, flag] : kFlags) {
    if (setting == name) return flag;
  }
  return setting;
}

}  // namespace facet
