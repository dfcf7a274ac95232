// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "apps/flags/reconstruct.h"

#include <gflags/gflags.h>

#include <limits>

#include "apps/flags/choices.h"
#include "apps/flags/keyframes.h"
#include "apps/flags/limits.h"
#include "apps/flags/optimisation.h"
#include "apps/flags/sequence.h"
#include "apps/init_app.h"
#include "util/errors.h"

using facet::AtlasOptions;
using facet::BakeOptions;
using facet::EnergyWeights;
using facet::GeometryOptions;
using facet::MergeOptions;
using facet::PartitionOptions;
using facet::PhotometricOptions;
using facet::SimplifyOptions;
using facet::SolverConfig;
using facet::TexelOptions;
using facet::VisibilityOptions;

// Run
DEFINE_string(mesh, "", "dense triangle mesh of the scan, PLY or OBJ [m]");
DEFINE_string(output, "", "run folder to write");
DEFINE_bool(overwrite, false, "write into a run folder that is not empty");
DEFINE_string(profile,
              "default",
              "default: facet's own settings; paper: the published method to "
              "the letter. Flags on the command line win");
DEFINE_string(from_stage,
              "partition",
              "first stage to run, earlier results are read from RUN/stages: "
              "partition, simplify, keyframes, photometric, geometry, export");
DEFINE_string(to_stage, "export", "last stage to run");
DEFINE_int32(threads, 0, "threads to use, 0 = one a core");
DEFINE_uint64(seed, 0, "recorded; nothing in the pipeline is random today");
DEFINE_bool(previews, true, "draw previews/*.png");
DEFINE_double(
    max_memory_gb,
    facet::ReconstructOptions().max_memory_gb,
    "hold images in a scratch file in the run folder if the plan "
    "expects to need more, and refuse what needs more even so, 0 = no "
    "limit; no result depends on it");
DEFINE_bool(trace_states,
            SolverConfig().trace_states,
            "keep poses and planes after every phase (trace_states.bin), from "
            "which facet-evaluate makes curves of their errors");

// Partition and planes
DEFINE_int32(partition_clusters,
             PartitionOptions().target_clusters,
             "clusters before merging");
DEFINE_double(
    partition_max_rms,
    PartitionOptions().max_rms_m,
    "stop merging faces at this rms height of a cluster [m], 0 = off");
DEFINE_bool(merge, MergeOptions().merge_planes, "merge adjacent planes");
DEFINE_double(merge_max_normal_deg,
              MergeOptions().max_normal_deg,
              "largest angle between merged planes (paper: 8)");
DEFINE_double(merge_max_distance,
              MergeOptions().max_distance_m,
              "largest mean distance to each other's plane [m] (paper: 0.05)");
DEFINE_double(merge_min_sheet_deg,
              MergeOptions().min_sheet_deg,
              "angle of centroid direction and normal above which two planes "
              "lie side by side (paper: 80)");
DEFINE_double(merge_max_rms,
              MergeOptions().max_rms_m,
              "largest rms height of a merged plane [m], 0 = off");
DEFINE_double(merge_max_drift,
              MergeOptions().max_drift_factor,
              "a cluster stays within this factor x merge_max_normal_deg of "
              "its plane, 0 = off");
DEFINE_double(merge_max_member_rms,
              MergeOptions().max_member_rms_m,
              "largest rms distance of a cluster to its merged plane [m], 0 = "
              "off");
DEFINE_bool(merge_islands,
            MergeOptions().absorb_islands,
            "small planes inside a large one that lie close to it join it");

// Simplification
DEFINE_string(
    simplify_stop,
    "budget",
    "budget: cheapest collapse first down to the face budget; counts: "
    "edge counts as published");
DEFINE_int32(simplify_faces,
             SimplifyOptions().target_faces,
             "face budget, 0 = by simplify_faces_per_m2");
DEFINE_double(simplify_faces_per_m2,
              SimplifyOptions().faces_per_m2,
              "face budget by surface");
DEFINE_double(
    simplify_sweep_ratio,
    SimplifyOptions().sweep_ratio,
    "budget: larger meshes are swept down to this many times the "
    "budget, which is faster, before collapses go by cost; 0 = never");
DEFINE_double(simplify_plane_share,
              SimplifyOptions().cluster_plane_share,
              "1 draws vertices into the planes, 0 to the dense surface");
DEFINE_double(simplify_plane_reach,
              SimplifyOptions().plane_reach_m,
              "a face at this distance from its plane counts half as much for "
              "it, and a tenth at three times the distance [m]; 0 = all the "
              "same");
DEFINE_int32(simplify_inner_target,
             SimplifyOptions().inner_target,
             "counts: inner edges left in a cluster");
DEFINE_double(simplify_border_ratio,
              SimplifyOptions().border_ratio,
              "counts: share of the border edges left");
DEFINE_int32(simplify_passes, SimplifyOptions().passes, "counts: passes");
DEFINE_string(
    plane_init,
    "dense",
    "the mesh that planes start from and that E_p holds them to: dense "
    "or simplified (paper)");

// Texels and visibility
DEFINE_double(texel_size,
              AtlasOptions().texel_size_m,
              "spacing of texels [m] (paper: 0.0025)");
DEFINE_int32(atlas_page_size, AtlasOptions().page_size, "largest page [px]");
DEFINE_int32(texel_stride,
             PhotometricOptions().stride,
             "every stride-th texel takes part in the optimisation; 0 = by "
             "max_observations (paper: 1)");
DEFINE_uint64(max_observations,
              PhotometricOptions().max_observations,
              "observations to stay below by choosing the stride");
DEFINE_bool(test_occlusion,
            VisibilityOptions().test_occlusion,
            "texels must not be hidden by the mesh");
DEFINE_bool(test_sensor_depth,
            VisibilityOptions().test_sensor_depth,
            "texels must agree with the sensor depth");
DEFINE_bool(allow_missing_depth,
            VisibilityOptions().allow_missing_depth,
            "texels without sensor depth pass its test");
DEFINE_bool(test_angle,
            VisibilityOptions().test_angle,
            "texels must not be seen at a grazing angle");
DEFINE_double(max_angle_deg,
              VisibilityOptions().max_angle_deg,
              "largest angle of view and normal");
DEFINE_bool(test_depth_edges,
            VisibilityOptions().test_depth_edges,
            "texels must not lie beside jumps of the sensor depth");
DEFINE_double(depth_weight,
              EnergyWeights().depth_weight,
              "weight of the distances of the depth images from the planes "
              "(configs/trajectory.flags), 0 = off");
DEFINE_double(edge_margin,
              TexelOptions().edge_margin_m,
              "texels of the optimisation keep away from sharp edges of the "
              "mesh [m] (configs/trajectory.flags), 0 = off");
DEFINE_bool(test_mesh_edges,
            VisibilityOptions().test_mesh_edges,
            "texels must not lie beside places where a surface of the mesh "
            "ends before another");
DEFINE_double(occlusion_tolerance,
              VisibilityOptions().occlusion_tolerance_m,
              "texels this far behind the mesh still count as seen [m]");
DEFINE_double(image_margin,
              VisibilityOptions().image_margin_px,
              "texels keep away from the image border [px]");
DEFINE_int32(min_views,
             VisibilityOptions().min_views,
             "texels seen by fewer keyframes take no part");

// Geometry and colours
DEFINE_double(lambda3,
              GeometryOptions().lambda3,
              "weight of the mesh's smoothness (paper: 1)");
DEFINE_int32(geometry_iterations,
             GeometryOptions().iterations,
             "projections onto the planes (paper: 1)");
DEFINE_string(geometry_freedom,
              "band",
              "band: distances that look like shape stay; none: everything is "
              "drawn to its plane (paper)");
DEFINE_double(geometry_band,
              GeometryOptions().band_m,
              "band: distances below it are noise [m]");
DEFINE_double(bake_angle_power,
              BakeOptions().angle_power,
              "final colours: power of cos(viewing angle)");
DEFINE_double(bake_depth_power,
              BakeOptions().depth_power,
              "final colours: power of 1/depth");
DEFINE_double(bake_sharpness_power,
              BakeOptions().sharpness_power,
              "final colours: power of the image's sharpness");
DEFINE_double(bake_best_view_power,
              BakeOptions().best_view_power,
              "final colours: power of the whole weight; large = best view");
DEFINE_double(
    bake_robust_luma,
    BakeOptions().robust_luma,
    "final colours: drop samples this far from the median (0-1), 0 = keep all");
DEFINE_double(bake_local_exposure,
              BakeOptions().local_exposure,
              "final colours: 0 = one exposure everywhere, 1 = that of the "
              "images that see a texel");
DEFINE_string(bake_sampler, "bilinear", "final colours: bilinear or bicubic");
DEFINE_int32(
    bake_visibility_px,
    BakeOptions().visibility_px,
    "final colours: one visibility test for a square of so many texels");

namespace facet {
namespace {

void Require(bool holds, const std::string& sentence) {
  if (!holds) throw OptionsError(sentence);
}

void CheckNumbers() {
  constexpr double kMax = std::numeric_limits<double>::max();
  CheckFlagLimits({
      {"threads", 0, 4096},
      {"max_memory_gb", 0, kMax},
      {"partition_clusters", 1},
      {"partition_max_rms", 0},
      {"merge_max_normal_deg", 0, 180, true},
      {"merge_max_distance", 0, kMax, true},
      {"merge_min_sheet_deg", 0, 90, false, true},
      {"merge_max_rms", 0},
      {"merge_max_drift", 0},
      {"merge_max_member_rms", 0},
      {"simplify_faces", 0},
      {"simplify_faces_per_m2", 0, kMax, true},
      {"simplify_inner_target", 0},
      {"simplify_border_ratio", 0, 1, true},
      {"simplify_passes", 1, 100},
      {"simplify_plane_share", 0, 1},
      {"simplify_plane_reach", 0, kMax},
      {"simplify_sweep_ratio", 0},
      {"texel_size", 0.0001, 0.1},
      {"atlas_page_size", 64, 32768},
      {"texel_stride", 0, 1000},
      {"max_observations", 1},
      {"max_angle_deg", 0, 90, true, true},
      {"image_margin", 0},
      {"min_views", 2},  // one view has no residual
      {"levels", 1, 6},
      {"stop_decrease", 0},
      {"smoothing", 0, 100},
      {"warp_columns", 2, 100},
      {"warp_rows", 2, 100},
      {"lambda1_share", 0, kMax, true},
      {"lambda2", 0, kMax, true},
      {"loss_scale", 0, 255, true},
      {"gauge_sigma_mm", 0, kMax, true},
      {"gauge_sigma_deg", 0, kMax, true},
      {"gauge_strength", 0, kMax, true},
      {"pose_iterations", 1, 10000},
      {"plane_iterations", 1, 10000},
      {"joint_iterations", 1, 10000},
      {"joint_tolerance", 0, 1},
      {"joint_hessian_every", 1, 10000},
      {"active_tolerance", 0, 1},
      {"lambda3", 0},
      {"geometry_iterations", 1, 10000},
      {"geometry_band", 0, kMax, true},
      {"bake_angle_power", 0, 100},
      {"bake_depth_power", 0, 100},
      {"bake_sharpness_power", 0, 100},
      {"bake_best_view_power", 0, 1000, true},
      {"bake_robust_luma", 0, kMax},
      {"bake_local_exposure", 0, 1},
      {"bake_visibility_px", 1, facet::kBakeTilePx},
  });
}

void MeshOptions(ReconstructOptions* o) {
  o->partition.target_clusters = FLAGS_partition_clusters;
  o->partition.max_rms_m = FLAGS_partition_max_rms;
  o->merge.merge_planes = FLAGS_merge;
  o->merge.max_normal_deg = FLAGS_merge_max_normal_deg;
  o->merge.max_distance_m = FLAGS_merge_max_distance;
  o->merge.min_sheet_deg = FLAGS_merge_min_sheet_deg;
  o->merge.max_rms_m = FLAGS_merge_max_rms;
  o->merge.max_drift_factor = FLAGS_merge_max_drift;
  o->merge.max_member_rms_m = FLAGS_merge_max_member_rms;
  o->merge.absorb_islands = FLAGS_merge_islands;
  o->simplify.stop = Choose("simplify_stop", FLAGS_simplify_stop) == 0
                         ? SimplifyStop::kBudget
                         : SimplifyStop::kCounts;
  o->simplify.target_faces = FLAGS_simplify_faces;
  o->simplify.faces_per_m2 = FLAGS_simplify_faces_per_m2;
  o->simplify.cluster_plane_share = FLAGS_simplify_plane_share;
  o->simplify.plane_reach_m = FLAGS_simplify_plane_reach;
  o->simplify.sweep_ratio = FLAGS_simplify_sweep_ratio;
  o->simplify.inner_target = FLAGS_simplify_inner_target;
  o->simplify.border_ratio = FLAGS_simplify_border_ratio;
  o->simplify.passes = FLAGS_simplify_passes;
  o->plane_init = Choose("plane_init", FLAGS_plane_init) == 0
                      ? PlaneInit::kDense
                      : PlaneInit::kSimplified;
}

void TextureOptions(ReconstructOptions* o) {
  o->atlas.texel_size_m = FLAGS_texel_size;
  o->atlas.page_size = FLAGS_atlas_page_size;
  o->photometric.stride = FLAGS_texel_stride;
  o->photometric.edge_margin_m = FLAGS_edge_margin;
  o->photometric.weights.depth_weight = FLAGS_depth_weight;
  o->photometric.max_observations = FLAGS_max_observations;
  VisibilityOptions& v = o->visibility;
  v.min_depth_m = o->sequence.min_depth_m;
  v.max_depth_m = o->sequence.max_depth_m;
  v.test_occlusion = FLAGS_test_occlusion;
  v.test_sensor_depth = FLAGS_test_sensor_depth;
  v.allow_missing_depth = FLAGS_allow_missing_depth;
  v.test_angle = FLAGS_test_angle;
  v.max_angle_deg = FLAGS_max_angle_deg;
  v.test_depth_edges = FLAGS_test_depth_edges;
  v.test_mesh_edges = FLAGS_test_mesh_edges;
  v.occlusion_tolerance_m = FLAGS_occlusion_tolerance;
  v.image_margin_px = FLAGS_image_margin;
  v.min_views = FLAGS_min_views;
  BakeOptions& b = o->bake;
  b.angle_power = FLAGS_bake_angle_power;
  b.depth_power = FLAGS_bake_depth_power;
  b.sharpness_power = FLAGS_bake_sharpness_power;
  b.best_view_power = FLAGS_bake_best_view_power;
  b.robust_luma = FLAGS_bake_robust_luma;
  b.local_exposure = FLAGS_bake_local_exposure;
  b.visibility_px = FLAGS_bake_visibility_px;
  b.sampler = Choose("bake_sampler", FLAGS_bake_sampler) == 0
                  ? BakeSampler::kBilinear
                  : BakeSampler::kBicubic;
}

void GeometryFlags(ReconstructOptions* o) {
  o->geometry.lambda3 = FLAGS_lambda3;
  o->geometry.iterations = FLAGS_geometry_iterations;
  o->geometry.band_m = FLAGS_geometry_band;
  o->geometry.freedom = Choose("geometry_freedom", FLAGS_geometry_freedom) == 0
                            ? PlaneFreedom::kBand
                            : PlaneFreedom::kNone;
}

}  // namespace

ReconstructOptions ReconstructOptionsFromFlags() {
  ReconstructOptions o;
  Require(!FLAGS_mesh.empty(), "--mesh is missing: give the dense mesh");
  Require(!FLAGS_output.empty(), "--output is missing: give the run folder");
  Require(!FLAGS_sequence.empty(),
          "--sequence is missing: give the folder of the scan");
  o.sequence_path = FLAGS_sequence;
  o.mesh_path = FLAGS_mesh;
  o.output_path = FLAGS_output;
  o.overwrite = FLAGS_overwrite;
  o.from_stage = ParseStage("from_stage", FLAGS_from_stage);
  o.to_stage = ParseStage("to_stage", FLAGS_to_stage);
  o.seed = FLAGS_seed;
  o.previews = FLAGS_previews;
  o.max_memory_gb = FLAGS_max_memory_gb;
  // The same model in one go, also when this command goes on in a run folder.
  o.flags_text = FlagsText({"from_stage", "overwrite"});
  CheckNumbers();
  o.sequence = SequenceOptionsFromFlags();
  o.sequence.keep_depth = true;  // every stage from the keyframes on reads it
  o.keyframes = KeyframeOptionsFromFlags();
  MeshOptions(&o);
  TextureOptions(&o);
  OptimisationOptionsFromFlags(&o.photometric);
  o.photometric.solver.trace_states = FLAGS_trace_states;
  GeometryFlags(&o);
  return o;
}

std::string ProfileFlags(const std::string& name) {
  if (Choose("profile", name) == 0) return "";
  // What the paper says, in the order of its sections (docs/cli.md).
  return "--simplify_stop=counts\n"
         "--simplify_plane_share=0\n"
         "--merge_max_rms=0\n"
         "--merge_max_drift=0\n"
         "--merge_max_member_rms=0\n"
         "--merge_islands=false\n"
         "--plane_init=simplified\n"
         "--max_observations=20000000\n"
         "--levels=1\n"
         "--schedule=10x[C; Phi; T+F]\n"
         "--stop_decrease=0\n"
         "--smoothing=0\n"
         "--noexposure\n"
         "--depth_weight=0\n"
         "--edge_margin=0\n"
         "--gauge=none\n"
         "--plane=raw4\n"
         "--lambda1_share=1\n"
         "--lambda2=0.1\n"
         "--geometry_iterations=1\n"
         "--geometry_freedom=none\n"
         "--bake_angle_power=0\n"
         "--bake_depth_power=0\n"
         "--bake_sharpness_power=0\n"
         "--bake_best_view_power=1\n"
         "--bake_robust_luma=0\n";
}

}  // namespace facet
