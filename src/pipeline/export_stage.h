// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The last stage: final colours and all files of the run folder.
#pragma once

#include <nlohmann/json.hpp>
#include <vector>

#include "pipeline/artefacts.h"
#include "pipeline/config.h"
#include "render/preview_views.h"
#include "rgbd/trajectory_io.h"
#include "texture/atlas.h"
#include "texture/keyframe_images.h"

namespace facet {

// Everything the earlier stages found.
struct ExportInput {
  const RgbdSequence& sequence;
  const MeshArtefact& dense;
  const MeshArtefact& simplified;
  const std::vector<int>& keyframes;
  const std::vector<Pose>& initial_cam_from_world;  // colour, a keyframe
  const std::vector<Plane>& initial_planes;
  const PhotometricArtefact& photometric;
  const TriMesh& final_mesh;
  const Atlas& atlas;
  const KeyframeImages& images;
  const std::vector<PreviewView>& views;  // of the previews
};

// poses.txt: all usable frames in the convention of the pose files. Keyframes
// (indices into the sequence's frames, ascending) get their optimised pose
// `cam_from_world` of the colour camera, the others are carried along with the
// corrections of their neighbours (PropagateCorrections).
std::vector<NumberedPose> RunPoses(const RgbdSequence& sequence,
                                   const std::vector<int>& keyframes,
                                   const std::vector<Pose>& cam_from_world);

// Writes mesh.obj, mesh.mtl, texture_*.png, mesh.glb, partition.ply,
// simplified.ply, planes.json, poses.txt and the previews of the light mesh.
// Returns the stage's part of report.json.
nlohmann::json ExportRun(const ReconstructOptions& options,
                         const ExportInput& input);

}  // namespace facet
