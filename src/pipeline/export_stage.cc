// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "pipeline/export_stage.h"

#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <utility>

#include "mesh/mesh_checks.h"
#include "mesh/mesh_io.h"
#include "mesh/partition.h"
#include "mesh/simplify.h"
#include "pipeline/previews.h"
#include "rgbd/trajectory_io.h"
#include "texture/bake.h"
#include "texture/glb_export.h"
#include "texture/obj_export.h"
#include "texture/seam_vertices.h"
#include "util/atomic_file.h"
#include "util/errors.h"
#include "util/resources.h"

namespace facet {
namespace {

using nlohmann::json;

json ToJson(const Eigen::Vector3d& v) {
  return json::array({v.x(), v.y(), v.z()});
}

}  // namespace

std::vector<NumberedPose> RunPoses(const RgbdSequence& sequence,
                                   const std::vector<int>& keyframes,
                                   const std::vector<Pose>& cam_from_world) {
  std::vector<int> numbers, usable_keyframes, frame_idx;
  std::vector<Pose> before;
  size_t next = 0;
  for (size_t i = 0; i < sequence.frames().size(); ++i) {
    if (!sequence.frames()[i].usable) continue;
    if (next < keyframes.size() && keyframes[next] == static_cast<int>(i)) {
      usable_keyframes.push_back(static_cast<int>(numbers.size()));
      ++next;
    }
    numbers.push_back(sequence.frames()[i].number);
    before.push_back(sequence.color_cam_from_world(static_cast<int>(i)));
  }
  const std::vector<Pose> after =
      PropagateCorrections(numbers, before, usable_keyframes, cam_from_world);
  std::vector<NumberedPose> poses;
  for (size_t i = 0; i < numbers.size(); ++i) {
    poses.push_back({numbers[i], sequence.PoseFileFromColorCam(after[i])});
  }
  return poses;
}

namespace {

void WritePlanes(const ReconstructOptions& options, const ExportInput& input) {
  const PlanarPartition& partition = input.simplified.partition;
  std::vector<int> faces(partition.clusters.size(), 0);
  for (const int j : partition.face_cluster) ++faces[j];
  PlanarPartition refit = partition;
  RefitClusters(input.final_mesh, &refit);
  json planes = json::array();
  for (size_t j = 0; j < partition.clusters.size(); ++j) {
    const PlaneCluster& cluster = partition.clusters[j];
    const Plane& before = input.initial_planes[j];
    const Plane& after = input.photometric.planes[j];
    const size_t frames = input.photometric.plane_frames[j];
    json plane = {
        {"id", j},
        {"normal", ToJson(after.normal)},
        {"offset", after.offset},
        {"initial",
         {{"normal", ToJson(before.normal)}, {"offset", before.offset}}},
        {"centroid", ToJson(cluster.centroid)},
        {"area_m2", cluster.area},
        {"dense_rms_m", cluster.rms},
        {"final_rms_m", refit.clusters[j].rms},
        {"faces", faces[j]},
        {"texels", input.photometric.plane_texels[j]},
        {"frames", frames}};
    if (frames == 0) plane["skipped"] = "no texel is seen by enough keyframes";
    planes.push_back(std::move(plane));
  }
  WriteFileAtomically(options.output_path + "/planes.json", planes.dump(1));
}

TexturedMesh MakeModel(const ExportInput& input,
                       const TriMesh& mesh,
                       std::vector<cv::Mat> pages) {
  TexturedMesh model;
  model.mesh = mesh;
  model.mesh.vertex_colors.clear();
  model.face_plane = input.simplified.partition.face_cluster;
  model.face_uv = input.atlas.face_uv;
  model.face_page = input.atlas.face_page;
  model.pages = std::move(pages);
  return model;
}

void WriteMasks(const ReconstructOptions& options, const BakeReport& report) {
  const auto name = [&](size_t page) {
    return options.output_path + "/texture_" + std::to_string(page) +
           "_unseen.png";
  };
  size_t stale = report.unseen_mask.size();  // of a larger model before
  while (std::filesystem::remove(name(stale))) ++stale;
  for (size_t page = 0; page < report.unseen_mask.size(); ++page) {
    const std::string path = name(page);
    WriteFileAtomically(path, [&](const std::string& temporary_path) {
      if (!cv::imwrite(temporary_path, report.unseen_mask[page])) {
        throw InputError("cannot write " + path);
      }
    });
  }
}

// The light mesh, and its texture after and before the optimisation.
void DrawLight(const std::string& dir,
               const ExportInput& input,
               const TextureBaker& baker,
               TexturedMesh model) {
  {
    const std::vector<SampledView> sampled =
        SampleViews(RayScene(model.mesh), model.mesh, input.views);
    DrawWireframe(
        dir, sampled, model.mesh, input.simplified.partition.face_cluster);
    DrawTextured(dir, "after", sampled, model);
  }
  model = TexturedMesh();
  ReturnFreedMemory();
  const TriMesh& start = input.simplified.mesh;
  const std::vector<SampledView> sampled =
      SampleViews(RayScene(start), start, input.views);
  KeyframeImages as_taken = input.images;
  as_taken.exposures.clear();
  const TextureState before = {
      start, input.initial_planes, as_taken, input.initial_cam_from_world, {}};
  DrawTextured(
      dir,
      "before",
      sampled,
      MakeModel(input, start, baker.BakeAs(before, SeenFaces(start, sampled))));
}

}  // namespace

json ExportRun(const ReconstructOptions& options, const ExportInput& input) {
  const std::string& dir = options.output_path;
  WritePly(dir + "/partition.ply",
           input.dense.mesh,
           &input.dense.partition.face_cluster);
  WritePly(dir + "/simplified.ply",
           input.simplified.mesh,
           &input.simplified.partition.face_cluster);
  WritePoses(
      dir + "/poses.txt",
      RunPoses(
          input.sequence, input.keyframes, input.photometric.cam_from_world));
  WritePlanes(options, input);

  const TextureState state = {input.final_mesh,
                              input.photometric.planes,
                              input.images,
                              input.photometric.cam_from_world,
                              input.photometric.warps};
  const RayScene scene(input.final_mesh);
  const TextureBaker baker(state,
                           input.atlas,
                           scene,
                           input.sequence,
                           input.keyframes,
                           input.photometric.lattice,
                           options.visibility,
                           options.bake);
  BakeReport bake;
  TexturedMesh model = MakeModel(input, input.final_mesh, baker.Bake(&bake));
  {
    const std::vector<std::string> pages = EncodePages(model);
    ExportObj(dir, model, pages);
    ExportGlb(dir + "/mesh.glb", model, pages);
  }
  WriteMasks(options, bake);
  if (options.previews) {
    DrawLight(dir + "/previews", input, baker, std::move(model));
  }

  const MeshChecks checks = CheckMesh(input.final_mesh);
  const FlippedFaces flipped =
      FindFlippedFaces(input.final_mesh, input.simplified.partition);
  return {{"mesh_checks",
           {{"non_manifold_edges", checks.non_manifold_edges},
            {"non_manifold_vertices", checks.non_manifold_vertices},
            {"duplicate_faces", checks.duplicate_faces},
            {"degenerate_faces", checks.degenerate_faces},
            {"flipped_faces", flipped.count},
            {"flipped_area_share", flipped.area_share},
            {"components", checks.components}}},
          {"texture",
           {{"pages", input.atlas.page_size.size()},
            {"charts", input.atlas.charts.size()},
            {"atlas_fill", input.atlas.fill},
            {"folded_charts", input.atlas.num_folded_charts},
            {"steep_faces", input.atlas.num_steep_faces},
            {"steep_area_m2", input.atlas.steep_area_m2},
            {"texels", bake.texels},
            {"texels_seen", bake.seen},
            {"samples", bake.samples},
            {"samples_dropped", bake.dropped},
            {"mean_views", bake.mean_views}}}};
}

}  // namespace facet
