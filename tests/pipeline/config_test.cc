// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "pipeline/config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "tests/support/temp_dir.h"
#include "util/atomic_file.h"
#include "util/errors.h"

namespace facet {
namespace {

using ::testing::HasSubstr;

std::vector<Stage> AllStages() {
  std::vector<Stage> stages;
  for (int s = 0; s < kNumStages; ++s) stages.push_back(static_cast<Stage>(s));
  return stages;
}

TEST(Stages, NamesReadBack) {
  for (const Stage stage : AllStages()) {
    EXPECT_EQ(ParseStage("from_stage", StageName(stage)), stage);
  }
}

TEST(Stages, UnknownNameListsAll) {
  for (const char* name : {"", "Partition", "export ", "bake"}) {
    try {
      ParseStage("to_stage", name);
      ADD_FAILURE() << name;
    } catch (const OptionsError& e) {
      EXPECT_THAT(e.what(), HasSubstr("--to_stage"));
      for (const Stage stage : AllStages()) {
        EXPECT_THAT(e.what(), HasSubstr(StageName(stage)));
      }
    }
  }
}

// Every option belongs to the settings of exactly one stage: breaks if a new
// option is forgotten in StageSettings, so that a resumed run would mix.
TEST(StageSettings, EveryOptionBelongsToOneStage) {
  using Change = std::function<void(ReconstructOptions*)>;
  const struct {
    Stage stage;
    Change change;
  } kCases[] = {
      {Stage::kPartition, [](auto* o) { o->mesh_path = "b.ply"; }},
      {Stage::kPartition, [](auto* o) { o->clean.weld_tolerance_m = 1e-4; }},
      {Stage::kPartition, [](auto* o) { o->partition.target_clusters = 3; }},
      {Stage::kPartition, [](auto* o) { o->partition.max_rms_m = 0.5; }},
      {Stage::kPartition, [](auto* o) { o->merge.merge_planes = false; }},
      {Stage::kPartition, [](auto* o) { o->merge.max_distance_m = 0.5; }},
      {Stage::kPartition, [](auto* o) { o->merge.min_sheet_deg = 50; }},
      {Stage::kPartition, [](auto* o) { o->merge.max_rms_m = 0.5; }},
      {Stage::kPartition, [](auto* o) { o->merge.max_drift_factor = 5; }},
      {Stage::kSimplify,
       [](auto* o) {
         o->simplify.stop = o->simplify.stop == SimplifyStop::kBudget
                                ? SimplifyStop::kCounts
                                : SimplifyStop::kBudget;
       }},
      {Stage::kSimplify, [](auto* o) { o->simplify.plane_reach_m = 0.5; }},
      {Stage::kSimplify, [](auto* o) { o->simplify.faces_per_m2 = 5; }},
      {Stage::kSimplify, [](auto* o) { o->simplify.inner_target = 5; }},
      {Stage::kSimplify, [](auto* o) { o->simplify.border_ratio = 0.5; }},
      {Stage::kSimplify, [](auto* o) { o->simplify.passes = 5; }},
      {Stage::kKeyframes, [](auto* o) { o->sequence_path = "other"; }},
      {Stage::kKeyframes, [](auto* o) { o->keyframes.window = 9; }},
      {Stage::kKeyframes, [](auto* o) { o->keyframes.holdout_offset = 2; }},
      {Stage::kKeyframes, [](auto* o) { o->sequence.max_depth_m = 2; }},
      {Stage::kKeyframes,
       [](auto* o) {
         o->sequence.extrinsic_direction = ExtrinsicDirection::kCamToRig;
       }},
      {Stage::kPhotometric,
       [](auto* o) { o->plane_init = PlaneInit::kSimplified; }},
      {Stage::kPhotometric, [](auto* o) { o->atlas.texel_size_m = 0.1; }},
      {Stage::kPhotometric, [](auto* o) { o->photometric.stride = 9; }},
      {Stage::kPhotometric,
       [](auto* o) { o->photometric.max_observations = 9; }},
      {Stage::kPhotometric, [](auto* o) { o->photometric.warp_rows = 9; }},
      {Stage::kPhotometric, [](auto* o) { o->photometric.schedule = "C"; }},
      {Stage::kPhotometric,
       [](auto* o) { o->photometric.stop.relative_decrease = 0.5; }},
      {Stage::kPhotometric,
       [](auto* o) { o->photometric.solver.max_joint_iterations = 77; }},
      {Stage::kPhotometric,
       [](auto* o) { o->photometric.solver.joint_tolerance = 0.5; }},
      {Stage::kPhotometric,
       [](auto* o) { o->photometric.formulation.plane = PlaneKind::kRaw4; }},
      {Stage::kPhotometric,
       [](auto* o) { o->photometric.formulation.manifold = PoseKind::kRight; }},
      {Stage::kPhotometric,
       [](auto* o) {
         o->photometric.formulation.sampling = Sampling::kScharr;
       }},
      {Stage::kPhotometric,
       [](auto* o) { o->photometric.formulation.loss = LossKind::kTukey; }},
      {Stage::kPhotometric,
       [](auto* o) { o->photometric.formulation.loss_scale = 0.7; }},
      {Stage::kPhotometric,
       [](auto* o) {
         o->photometric.formulation.out_of_image = OutOfImage::kDrop;
       }},
      {Stage::kPhotometric,
       [](auto* o) { o->photometric.formulation.channels = Channels::kRgb; }},
      {Stage::kPhotometric,
       [](auto* o) {
         o->photometric.formulation.evaluation = Evaluation::kReference;
       }},
      {Stage::kPhotometric,
       [](auto* o) { o->photometric.solver.fix_first_pose = true; }},
      {Stage::kPhotometric,
       [](auto* o) { o->photometric.weights.lambda2 = 7; }},
      {Stage::kPhotometric,
       [](auto* o) { o->photometric.weights.prior.rotation_rad = 1; }},
      {Stage::kPhotometric, [](auto* o) { o->visibility.min_views = 7; }},
      {Stage::kPhotometric,
       [](auto* o) { o->visibility.allow_missing_depth = true; }},
      {Stage::kGeometry, [](auto* o) { o->geometry.lambda3 = 7; }},
      {Stage::kGeometry, [](auto* o) { o->geometry.iterations = 77; }},
      {Stage::kGeometry, [](auto* o) { o->geometry.band_m = 0.5; }},
      {Stage::kGeometry,
       [](auto* o) { o->geometry.freedom = PlaneFreedom::kNone; }},
      {Stage::kExport, [](auto* o) { o->atlas.page_size = 512; }},
      {Stage::kExport, [](auto* o) { o->bake.angle_power = 7; }},
      {Stage::kExport, [](auto* o) { o->bake.robust_luma = 0.7; }},
      {Stage::kExport,
       [](auto* o) { o->bake.sampler = BakeSampler::kBicubic; }},
  };
  const ReconstructOptions before;
  for (size_t i = 0; i < std::size(kCases); ++i) {
    ReconstructOptions after;
    kCases[i].change(&after);
    for (const Stage stage : AllStages()) {
      EXPECT_EQ(StageSettings(before, stage) != StageSettings(after, stage),
                stage == kCases[i].stage)
          << "case " << i << ", settings of " << StageName(stage);
    }
  }
}

// Where the results go, what is drawn and which stages run is no setting.
TEST(StageSettings, WhereAndWhenIsFree) {
  const ReconstructOptions before;
  ReconstructOptions after;
  after.output_path = "elsewhere";
  after.overwrite = true;
  after.from_stage = Stage::kGeometry;
  after.previews = false;
  after.flags_text = "text";
  for (const Stage stage : AllStages()) {
    EXPECT_EQ(StageSettings(before, stage), StageSettings(after, stage));
  }
}

// Settings are compared after a trip through the text of a file.
TEST(StageSettings, SurviveText) {
  ReconstructOptions options;
  options.geometry.lambda3 = 0.1 + 0.2;
  options.merge.max_normal_deg = 1.0 / 3;
  options.photometric.weights.prior.rotation_rad = 0.3 * M_PI / 180;
  for (const Stage stage : AllStages()) {
    const nlohmann::json settings = StageSettings(options, stage);
    EXPECT_EQ(nlohmann::json::parse(settings.dump()), settings);
  }
}

// A mesh that was fused again under the same name is noticed.
TEST(StageSettings, ReplacedMeshIsNoticed) {
  const TempDir dir;
  ReconstructOptions options;
  options.mesh_path = dir / "dense.ply";
  WriteFileAtomically(options.mesh_path, "one");
  const nlohmann::json before = StageSettings(options, Stage::kPartition);
  WriteFileAtomically(options.mesh_path, "another");
  EXPECT_NE(StageSettings(options, Stage::kPartition), before);
}

}  // namespace
}  // namespace facet
