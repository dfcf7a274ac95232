// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "pipeline/reconstruct.h"

#include <cmath>
#include <cstdio>
#include <filesystem>

#include "eval/trajectory_error.h"
#include "pipeline/artefacts.h"
#include "pipeline/export_stage.h"
#include "pipeline/meanwhile.h"
#include "pipeline/mesh_stages.h"
#include "pipeline/preflight.h"
#include "pipeline/report.h"
#include "pipeline/stage_clock.h"
#include "util/atomic_file.h"
#include "util/background.h"
#include "util/errors.h"
#include "util/parallel_for.h"
#include "util/resources.h"
#include "util/warnings.h"

namespace facet {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

template <typename... Args>
std::string Format(const char* format, Args... args) {
  char text[400];
  std::snprintf(text, sizeof(text), format, args...);
  return text;
}

// One run: the options, what is loaded, and the report as it grows.
class Run {
 public:
  explicit Run(const ReconstructOptions& options) : options_(options) {}

  json Execute() {
    CheckFolder();
    CheckOptions(options_);
    sequence_ = OpenSequence(options_.sequence_path, options_.sequence);
    meanwhile_ = std::make_unique<Meanwhile>(options_, *sequence_);
    // Under a limit the plan must say first where images go.
    if (!(options_.max_memory_gb > 0)) ReadImages();
    RunPartition();
    if (Wanted(Stage::kSimplify)) RunSimplify();
    if (Wanted(Stage::kKeyframes)) RunKeyframes();
    if (Wanted(Stage::kPhotometric)) RunPhotometric();
    if (Wanted(Stage::kGeometry)) RunGeometry();
    if (Wanted(Stage::kExport)) RunExport();
    return WriteReport();
  }

 private:
  bool Wanted(Stage stage) const { return stage <= options_.to_stage; }
  bool FromFile(Stage stage) const { return stage < options_.from_stage; }
  bool ReadsImages() const {
    return !FromFile(Stage::kKeyframes) && Wanted(Stage::kKeyframes);
  }

  // What can be refused is refused before the work starts.
  void CheckFolder() const {
    if (options_.from_stage > options_.to_stage) {
      throw OptionsError("--from_stage comes after --to_stage");
    }
    const fs::path dir(options_.output_path);
    if (options_.from_stage == Stage::kPartition && fs::exists(dir) &&
        !(fs::is_directory(dir) && fs::is_empty(dir)) && !options_.overwrite) {
      throw OptionsError("--output=" + options_.output_path +
                         " is not empty: give another folder, --overwrite, or "
                         "go on in it with --from_stage");
    }
  }

  StageClock Begin(const char* stage) {
    warnings_before_ = Warnings().size();
    return StageClock(stage);
  }

  // Those of the present stage: kept with its result, for runs that resume.
  std::vector<std::string> StageWarnings() const {
    const std::vector<std::string> all = Warnings();
    return {all.begin() + warnings_before_, all.end()};
  }

  // Called when all input is read and accepted: a refused command leaves the
  // run folder as it was. The report of an earlier run would contradict the
  // files to come.
  void BeginWriting() {
    if (writing_) return;
    writing_ = true;
    WriteFileAtomically(options_.output_path + "/flags.txt",
                        options_.flags_text);
    std::error_code ignored;
    fs::remove(options_.output_path + "/report.json", ignored);
  }

  void AnnouncePlan() {
    const SceneSize size = MeasureScene(options_, dense_.mesh, *sequence_);
    place_ = FitIntoMemory(options_, size);
    const MemoryEstimate estimate = EstimateMemory(options_, size, place_);
    draw_early_ = estimate.DrawsBesideMesh();
    const double available = AvailableMemoryMb();
    PrintLine("plan          " + DescribePlan(size, estimate, available));
    const bool in_file = place_ == ImagePlace::kFile;
    report_["memory"] = {{"estimate_mb", estimate.PeakMb()},
                         {"available_mb", available},
                         {"images", in_file ? "file" : "memory"},
                         {"file_mb", estimate.file_mb}};
  }

  // Begins to, if that is not done yet.
  void ReadImages() {
    if (place_ == ImagePlace::kFile) {
      store_ = ImageStore::InFolder(options_.output_path);
    }
    sequence_->KeepDepthIn(store_);
    if (ReadsImages()) meanwhile_->ReadImages(store_);
  }

  void RunPartition() {
    StageClock clock = Begin("partition");
    if (FromFile(Stage::kPartition)) {
      dense_ = LoadMeshArtefact(options_, Stage::kPartition);
      RestoreWarnings(dense_.warnings);
      AnnouncePlan();
      if (options_.max_memory_gb > 0) ReadImages();
      stages_.push_back(clock.Finish("read"));
      return;
    }
    dense_ = ReadDenseMesh(options_);
    AnnouncePlan();
    BeginWriting();
    if (options_.max_memory_gb > 0) ReadImages();
    PartitionDense(options_, &dense_);
    dense_.warnings = StageWarnings();
    Save(options_, Stage::kPartition, dense_);
    const json& done = dense_.report;
    stages_.push_back(clock.Finish(
        Format("%zu faces, %zu clusters (rms %.2f mm), %zu planes (%.2f mm)",
               dense_.mesh.NumFaces(),
               done.at("clusters").get<size_t>(),
               1e3 * done.at("rms_before_merging_m").get<double>(),
               done.at("planes").get<size_t>(),
               1e3 * done.at("rms_after_merging_m").get<double>())));
  }

  void RunSimplify() {
    StageClock clock = Begin("simplify");
    if (ReadsImages() && draw_early_) {
      meanwhile_->DrawDense(
          dense_, sequence_->ColorPoses(meanwhile_->Keyframes().keyframes));
    }
    if (FromFile(Stage::kSimplify)) {
      simplified_ = LoadMeshArtefact(options_, Stage::kSimplify);
      RestoreWarnings(simplified_.warnings);
      stages_.push_back(clock.Finish("read"));
      return;
    }
    BeginWriting();
    simplified_ = SimplifyDense(options_, dense_);
    simplified_.warnings = StageWarnings();
    Save(options_, Stage::kSimplify, simplified_);
    stages_.push_back(clock.Finish(
        Format("%zu vertices, %zu faces (%.1f %%)",
               simplified_.mesh.NumVertices(),
               simplified_.mesh.NumFaces(),
               100.0 * static_cast<double>(simplified_.mesh.NumFaces()) /
                   static_cast<double>(dense_.mesh.NumFaces()))));
  }

  void RunKeyframes() {
    StageClock clock = Begin("keyframes");
    if (FromFile(Stage::kKeyframes)) {
      keyframes_ = LoadKeyframeArtefact(options_);
      RestoreWarnings(keyframes_.warnings);
      stages_.push_back(clock.Finish("read"));
      return;
    }
    BeginWriting();
    WarnOfConventions(*sequence_, dense_.mesh, options_.visibility);
    const KeyframeChoice& choice = meanwhile_->Keyframes();
    CheckKeyframes(*sequence_, choice);
    keyframes_.keyframes = choice.keyframes;
    keyframes_.blur = choice.blur;
    keyframes_.report =
        KeyframeReport(*sequence_, keyframes_.keyframes, options_.keyframes);
    keyframes_.warnings = StageWarnings();
    Save(options_, keyframes_);
    stages_.push_back(
        clock.Finish(Format("%zu of %zu usable frames, %zu held out",
                            keyframes_.keyframes.size(),
                            keyframes_.report.at("usable").get<size_t>(),
                            keyframes_.report.at("held_out").get<size_t>())));
  }

  // What several later stages need: poses, images, atlas.
  void LoadForTexture() {
    if (!initial_poses_.empty()) return;
    initial_poses_ = sequence_->ColorPoses(keyframes_.keyframes);
    images_ = meanwhile_->TakeColors();
    if (images_.size() == 0) {
      images_ = LoadKeyframeColors(*sequence_, keyframes_.keyframes, store_);
    }
    atlas_ =
        BuildAtlas(simplified_.mesh, simplified_.partition, options_.atlas);
    if (options_.plane_init == PlaneInit::kSimplified) {
      initial_planes_ = simplified_.refitted_planes;
    } else {
      for (const PlaneCluster& cluster : simplified_.partition.clusters) {
        initial_planes_.push_back(cluster.plane);
      }
    }
  }

  void RunPhotometric() {
    StageClock clock = Begin("photometric");
    if (FromFile(Stage::kPhotometric)) {
      photometric_ = LoadPhotometricArtefact(options_);
      RestoreWarnings(photometric_.warnings);
      stages_.push_back(clock.Finish("read"));
      return;
    }
    BeginWriting();
    std::vector<SurfaceMoments> surface;
    Background surface_moments([&] {
      if (options_.plane_init != PlaneInit::kDense) return;
      surface = ClusterMoments(dense_.mesh,
                               dense_.partition.face_cluster,
                               dense_.partition.clusters.size());
    });
    LoadForTexture();
    surface_moments.Finish();
    const PhotometricResult result = RunPhotometricStage(simplified_.mesh,
                                                         simplified_.partition,
                                                         initial_planes_,
                                                         surface,
                                                         atlas_,
                                                         *sequence_,
                                                         keyframes_.keyframes,
                                                         initial_poses_,
                                                         options_.visibility,
                                                         options_.photometric,
                                                         &images_,
                                                         PrintLine);
    WriteFileAtomically(options_.output_path + "/trace.csv",
                        TraceCsv(result.trace));
    SaveTraceStates(options_,
                    sequence_->Numbers(keyframes_.keyframes),
                    {initial_poses_, initial_planes_},
                    result.trace);
    photometric_.cam_from_world = result.cam_from_world;
    photometric_.planes = result.planes;
    photometric_.warps = result.warps;
    photometric_.lattice = result.lattice;
    photometric_.exposures = result.exposure.exposures;
    photometric_.plane_texels = result.plane_texels;
    photometric_.plane_frames = result.plane_frames;
    const RigidMotion slide =
        CommonMotion(initial_poses_, result.cam_from_world);
    photometric_.report = PhotometricReport(result, slide);
    photometric_.warnings = StageWarnings();
    Save(options_, photometric_);
    stages_.push_back(clock.Finish(Format(
        "%zu texels, %zu observations, rms grey %.2f -> %.2f, slide %.1f mm",
        result.texels_observed,
        result.initial.observations,
        result.initial.rms_grey,
        result.final_terms.rms_grey,
        slide.mm)));
  }

  void RunGeometry() {
    StageClock clock = Begin("geometry");
    if (FromFile(Stage::kGeometry)) {
      geometry_ = LoadGeometryArtefact(options_);
      RestoreWarnings(geometry_.warnings);
      stages_.push_back(clock.Finish("read"));
      return;
    }
    BeginWriting();
    geometry_.mesh = simplified_.mesh;
    const GeometrySummary summary = FitGeometry(simplified_.partition,
                                                photometric_.planes,
                                                options_.atlas.texel_size_m,
                                                options_.geometry,
                                                &geometry_.mesh);
    geometry_.report = GeometryReport(summary);
    geometry_.warnings = StageWarnings();
    Save(options_, geometry_);
    stages_.push_back(
        clock.Finish(Format("rms to planes %.2f -> %.2f mm, mean move %.2f mm",
                            1e3 * summary.plane_rms_before,
                            1e3 * summary.plane_rms_after,
                            1e3 * summary.mean_move_m)));
  }

  void RunExport() {
    StageClock clock = Begin("export");
    BeginWriting();
    LoadForTexture();
    images_.exposures = photometric_.exposures;
    images_.smooth.clear();
    ReturnFreedMemory();
    meanwhile_->DrawDense(dense_, initial_poses_);
    const std::vector<PreviewView> views = meanwhile_->Views();
    ReturnFreedMemory();
    const ExportInput input = {*sequence_,
                               dense_,
                               simplified_,
                               keyframes_.keyframes,
                               initial_poses_,
                               initial_planes_,
                               photometric_,
                               geometry_.mesh,
                               atlas_,
                               images_,
                               views};
    export_report_ = ExportRun(options_, input);
    stages_.push_back(clock.Finish("run folder " + options_.output_path));
  }

  json WriteReport() {
    if (options_.to_stage == Stage::kExport) {
      report_["result"] = {{"vertices", geometry_.mesh.NumVertices()},
                           {"faces", geometry_.mesh.NumFaces()},
                           {"planes", dense_.partition.clusters.size()}};
      report_["mesh_checks"] = export_report_["mesh_checks"];
      report_["texture"] = export_report_["texture"];
    }
    report_["partition"] = dense_.report;
    report_["simplify"] = simplified_.report;
    report_["keyframe_selection"] = keyframes_.report;
    report_["keyframes"] = keyframes_.keyframes.size();
    if (photometric_.report.is_object()) report_.update(photometric_.report);
    report_["geometry"] = geometry_.report;
    report_["stages"] = stages_;
    AddEnvironment(&report_);
    json settings = json::object();
    for (int s = 0; s < kNumStages; ++s) {
      const Stage stage = static_cast<Stage>(s);
      settings[StageName(stage)] = StageSettings(options_, stage);
    }
    report_["options"] = settings;
    report_["warnings"] = WithoutRepetitions(Warnings());
    WriteFileAtomically(options_.output_path + "/report.json", report_.dump(1));
    return report_;
  }

  ReconstructOptions options_;
  std::unique_ptr<RgbdSequence> sequence_;
  MeshArtefact dense_, simplified_;
  KeyframeArtefact keyframes_;
  PhotometricArtefact photometric_;
  GeometryArtefact geometry_;
  std::vector<Pose> initial_poses_;  // colour camera, a keyframe
  std::vector<Plane> initial_planes_;
  ImagePlace place_ = ImagePlace::kMemory;
  ImageStore store_;  // of images, as place_ says
  KeyframeImages images_;
  Atlas atlas_;
  bool draw_early_ = false;  // the dense mesh, while it is simplified
  std::unique_ptr<Meanwhile> meanwhile_;  // reads options_, sequence_, dense_
  bool writing_ = false;
  ptrdiff_t warnings_before_ = 0;
  json stages_ = json::array(), export_report_, report_ = json::object();
};

}  // namespace

void CheckOptions(const ReconstructOptions& options) {
  const PhotometricOptions& p = options.photometric;
  const JointMethod joint = p.solver.joint_method;
  CheckFormulation(p.formulation,
                   PhasesOf(ParseSchedule(p.schedule, joint), joint));
}

json Reconstruct(const ReconstructOptions& options) {
  return Run(options).Execute();
}

}  // namespace facet
