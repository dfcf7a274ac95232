// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// All options of facet-reconstruct. Defaults live in the structs of the stages
// and nowhere else.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "mesh/clean.h"
#include "mesh/merge.h"
#include "mesh/partition.h"
#include "mesh/simplify.h"
#include "pipeline/photometric_stage.h"
#include "pipeline/stages.h"
#include "problems/geometry_problem.h"
#include "rgbd/keyframes.h"
#include "rgbd/sequence.h"
#include "texture/atlas.h"
#include "texture/bake.h"
#include "texture/observations.h"

namespace facet {

// Which mesh says where the planes are: the photometric step starts from planes
// fitted to its clusters (method, Sec. 3.6), and E_p holds them to it.
enum class PlaneInit {
  kDense,
  kSimplified,  // the paper and the authors' code: to its texels
};

struct ReconstructOptions {
  std::string sequence_path, mesh_path, output_path;
  bool overwrite = false;
  Stage from_stage = Stage::kPartition, to_stage = Stage::kExport;
  uint64_t seed = 0;  // nothing of the default pipeline is random
  bool previews = true;
  double max_memory_gb = 0;  // see pipeline/preflight.h; 0 = no limit
  std::string flags_text;    // written to flags.txt

  SequenceOptions sequence;
  CleanOptions clean;
  PartitionOptions partition;
  MergeOptions merge;
  SimplifyOptions simplify;
  PlaneInit plane_init = PlaneInit::kDense;
  KeyframeOptions keyframes;
  AtlasOptions atlas;
  VisibilityOptions visibility;
  PhotometricOptions photometric;
  GeometryOptions geometry;
  BakeOptions bake;
};

// The options that determine the result of `stage`, given the artefact of the
// stage before: what the resume guard compares and report.json records.
nlohmann::json StageSettings(const ReconstructOptions& options, Stage stage);

// The flag of facet-reconstruct that determines a setting of StageSettings, for
// messages; the setting's own name if there is no other.
std::string FlagOfSetting(const std::string& setting);

}  // namespace facet
