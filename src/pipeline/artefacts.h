// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Results of the stages and how they are kept in RUN/stages/<stage>.bin. Each
// file carries the settings of its stage and of all before; going on from it
// with other settings is refused (OptionsError naming the flag).
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "eval/trace_states.h"
#include "mesh/planar_partition.h"
#include "mesh/tri_mesh.h"
#include "pipeline/config.h"
#include "schedule/run_schedule.h"

namespace facet {

// What a stage has to say, beside its result.
struct StageRecord {
  nlohmann::json report;              // the stage's part of report.json
  std::vector<std::string> warnings;  // raised by the stage
};

// partition: the cleaned dense mesh. simplify: the light mesh.
struct MeshArtefact : StageRecord {
  TriMesh mesh;
  PlanarPartition partition;
  std::vector<Plane> refitted_planes;  // simplify: fitted to the light mesh
};

struct KeyframeArtefact : StageRecord {
  std::vector<int> keyframes;  // indices into the sequence's frames
  std::vector<double> blur;    // by frame index, NaN = not measured
};

// Poses, planes and warps after the schedule.
struct PhotometricArtefact : StageRecord {
  std::vector<Pose> cam_from_world;  // colour camera, a keyframe
  std::vector<Plane> planes;
  std::vector<double> warps;  // empty = none
  WarpLattice lattice;
  std::vector<Exposure> exposures;  // a keyframe; empty = as taken
  std::vector<size_t> plane_texels, plane_frames;
};

// The final mesh after the fit; geometry keeps labels and texture coordinates.
struct GeometryArtefact : StageRecord {
  TriMesh mesh;
};

std::string ArtefactPath(const ReconstructOptions& options, Stage stage);

void Save(const ReconstructOptions&, Stage, const MeshArtefact&);
void Save(const ReconstructOptions&, const KeyframeArtefact&);
void Save(const ReconstructOptions&, const PhotometricArtefact&);
void Save(const ReconstructOptions&, const GeometryArtefact&);

// Throw InputError (missing: names the stage to run; damaged) and OptionsError
// (made with other settings: names the flag and both values).
MeshArtefact LoadMeshArtefact(const ReconstructOptions&, Stage);
KeyframeArtefact LoadKeyframeArtefact(const ReconstructOptions&);
PhotometricArtefact LoadPhotometricArtefact(const ReconstructOptions&);
GeometryArtefact LoadGeometryArtefact(const ReconstructOptions&);

// RUN/trace_states.bin: `start`, then the state after every row of the trace.
// Without SolverConfig::trace_states the file of an earlier run is removed:
// none may stay that does not fit trace.csv.
void SaveTraceStates(const ReconstructOptions&,
                     const std::vector<int>& frame_numbers,  // a keyframe
                     const TraceState& start,
                     const Trace& trace);

}  // namespace facet
