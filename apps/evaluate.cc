// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// facet-evaluate: models against photos, a reference mesh and the truth.
#include <gflags/gflags.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>

#include "apps/flags/sequence.h"
#include "apps/init_app.h"
#include "eval/evaluation_report.h"
#include "eval/trace_states.h"
#include "mesh/mesh_io.h"
#include "rgbd/trajectory_io.h"
#include "texture/model_io.h"
#include "util/atomic_file.h"
#include "util/errors.h"
#include "util/parallel_for.h"
#include "util/resources.h"
#include "util/warnings.h"

DEFINE_string(model,
              "",
              "what to evaluate: run folders of facet-reconstruct, textured "
              "OBJ or vertex-coloured PLY or OBJ files, separated by commas");
DEFINE_int32(frames_stride,
             25,
             "evaluate frames whose number is frames_offset modulo this; 1 = "
             "all");
DEFINE_int32(frames_offset, 7, "see frames_stride");
DEFINE_bool(photos, true, "compare models with the photos of --sequence");
DEFINE_string(frames,
              "",
              "frame numbers separated by commas, instead of frames_stride");
DEFINE_string(poses,
              "",
              "poses.txt (number, 4x4 camera-to-world of the pose files' "
              "camera) to use for all models instead of the sequence's poses");
DEFINE_bool(use_run_poses,
            true,
            "for a run folder with poses.txt use its poses, where the "
            "corrections of the keyframes are carried over to all frames");
DEFINE_string(reference_mesh,
              "",
              "PLY or OBJ to measure distances to and from");
DEFINE_uint64(num_points,
              facet::MeshDistanceOptions().num_points,
              "points on each mesh for distances");
DEFINE_uint64(seed, 0, "of the points");
DEFINE_string(true_poses, "", "poses.txt with the true poses");
DEFINE_double(frames_per_second, 30, "of the scan, for errors over 1 s");
DEFINE_string(true_planes, "", "JSON with the true planes");
DEFINE_string(true_mesh, "", "PLY with a plane_id a face, of true_planes");
DEFINE_string(output, "", "JSON file to write");
DEFINE_string(dump_images,
              "",
              "folder for pictures photo | model | difference of each frame");
DEFINE_int32(threads, 0, "0 = one per core");

namespace facet {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> SplitAtCommas(const std::string& text) {
  std::vector<std::string> parts;
  std::stringstream stream(text);
  for (std::string part; std::getline(stream, part, ',');) {
    if (!part.empty()) parts.push_back(part);
  }
  return parts;
}

void CheckFlags() {
  if (FLAGS_model.empty()) {
    throw OptionsError("--model is missing: name a run folder, OBJ or PLY");
  }
  if (FLAGS_frames_stride < 1) {
    throw OptionsError("--frames_stride must be at least 1");
  }
  if (FLAGS_num_points < 1) {
    throw OptionsError("--num_points must be at least 1");
  }
  if (!(FLAGS_frames_per_second > 0)) {
    throw OptionsError("--frames_per_second must be positive");
  }
  if (FLAGS_true_planes.empty() != FLAGS_true_mesh.empty()) {
    throw OptionsError("--true_planes and --true_mesh need each other");
  }
  if (!FLAGS_true_poses.empty() && FLAGS_sequence.empty()) {
    throw OptionsError("--true_poses needs --sequence");
  }
  if (!FLAGS_dump_images.empty()) {
    std::error_code error;
    fs::create_directories(FLAGS_dump_images, error);
    if (error) {
      throw InputError("cannot create the folder " + FLAGS_dump_images +
                       " of --dump_images: " + error.message());
    }
  }
}

// Indices of the frames to evaluate.
std::vector<int> ChooseFrames(const RgbdSequence& sequence) {
  std::set<int> wanted;
  for (const std::string& part : SplitAtCommas(FLAGS_frames)) {
    try {
      size_t end = 0;
      wanted.insert(std::stoi(part, &end));
      if (end != part.size()) throw std::invalid_argument(part);
    } catch (const std::exception&) {
      throw OptionsError("--frames: '" + part + "' is not a frame number");
    }
  }
  const int stride = FLAGS_frames_stride;
  const int offset = (FLAGS_frames_offset % stride + stride) % stride;
  std::vector<int> chosen;
  for (size_t i = 0; i < sequence.frames().size(); ++i) {
    const Frame& frame = sequence.frames()[i];
    const bool is_wanted = wanted.empty() ? frame.number % stride == offset
                                          : wanted.count(frame.number) > 0;
    if (is_wanted && frame.usable) chosen.push_back(static_cast<int>(i));
  }
  if (chosen.empty()) {
    throw OptionsError(
        "no usable frame has the numbers asked for by --frames or "
        "--frames_stride and --frames_offset");
  }
  return chosen;
}

std::vector<NumberedPose> SequencePoses(const RgbdSequence& sequence) {
  std::vector<NumberedPose> poses;
  for (size_t i = 0; i < sequence.frames().size(); ++i) {
    if (!sequence.frames()[i].usable) continue;
    poses.push_back({sequence.frames()[i].number,
                     sequence.PoseFileFromColorCam(
                         sequence.color_cam_from_world(static_cast<int>(i)))});
  }
  return poses;
}

// The file that holds the poses of a model's frames; "" = the sequence.
std::string PoseFile(const std::string& model) {
  if (!FLAGS_poses.empty()) return FLAGS_poses;
  const fs::path of_run = fs::path(model) / "poses.txt";
  const bool has_poses = fs::is_directory(model) && fs::exists(of_run);
  return FLAGS_use_run_poses && has_poses ? of_run.string() : "";
}

// The chosen frames that have a pose; warns about the others.
std::vector<EvaluationFrame> FramesWithPoses(
    const RgbdSequence& sequence,
    const std::vector<int>& chosen,
    const std::vector<NumberedPose>& poses) {
  std::map<int, Pose> by_number;
  for (const NumberedPose& p : poses) by_number[p.number] = p.world_from_cam;
  std::vector<EvaluationFrame> frames;
  for (const int i : chosen) {
    const int number = sequence.frames()[i].number;
    const auto it = by_number.find(number);
    if (it == by_number.end()) continue;
    frames.push_back({i, number, sequence.ColorCamFromPoseFile(it->second)});
  }
  if (frames.empty()) {
    throw InputError("the poses hold none of the frames to evaluate");
  }
  if (frames.size() < chosen.size()) {
    AddWarning(std::to_string(chosen.size() - frames.size()) + " of " +
               std::to_string(chosen.size()) +
               " frames to evaluate have no pose in the pose file");
  }
  return frames;
}

void EvaluatePhotosAndPoses(const RgbdSequence& sequence,
                            const TexturedMesh& model,
                            const std::string& dump_prefix,
                            ModelReport* report) {
  const std::string pose_file = PoseFile(report->model);
  report->pose_source = pose_file.empty() ? "sequence" : pose_file;
  const std::vector<NumberedPose> of_sequence = SequencePoses(sequence);
  const std::vector<NumberedPose> poses =
      pose_file.empty() ? of_sequence : ReadPoses(pose_file);
  if (HasColor(model) && FLAGS_photos) {
    EvaluationOptions options;
    options.dump_prefix = dump_prefix;
    report->photometric =
        EvaluateModel(model,
                      sequence,
                      FramesWithPoses(sequence, ChooseFrames(sequence), poses),
                      options);
  } else if (FLAGS_photos) {
    AddWarning("'" + report->model +
               "' has no colours: it is not compared with photos");
  }
  if (FLAGS_true_poses.empty()) return;
  const std::vector<NumberedPose> truth = ReadPoses(FLAGS_true_poses);
  report->trajectory =
      CompareTrajectories(poses, truth, FLAGS_frames_per_second);
  if (!pose_file.empty()) {
    report->input_trajectory =
        CompareTrajectories(of_sequence, truth, FLAGS_frames_per_second);
  }
}

// Errors after every phase of a run that kept its states. `matches` are of its
// planes, empty without true planes.
void EvaluateTrace(const RgbdSequence* sequence,
                   const std::vector<PlaneMatch>& matches,
                   ModelReport* report) {
  const fs::path file = fs::path(report->model) / "trace_states.bin";
  const bool poses = !FLAGS_true_poses.empty();
  if (!fs::exists(file) || (!poses && matches.empty())) return;
  const TraceStates trace = ReadTraceStates(file.string());
  std::vector<NumberedPose> true_poses;
  if (poses) true_poses = ReadPoses(FLAGS_true_poses);
  std::vector<NumberedPlane> true_planes;
  if (!matches.empty()) true_planes = ReadPlanes(FLAGS_true_planes);
  for (const TraceState& state : trace.states) {
    TraceErrors errors;
    if (poses) {
      std::vector<NumberedPose> keyframes;
      for (size_t k = 0; k < trace.keyframes.size(); ++k) {
        keyframes.push_back(
            {trace.keyframes[k],
             sequence->PoseFileFromColorCam(state.cam_from_world[k])});
      }
      const TrajectoryError error =
          CompareTrajectories(keyframes, true_poses, FLAGS_frames_per_second);
      errors.ate_m = error.ate.rmse;
      errors.rotation_deg = error.rotation.rmse;
    }
    if (!matches.empty()) {
      std::vector<NumberedPlane> planes;
      for (const Plane& plane : state.planes) {
        planes.push_back({static_cast<int>(planes.size()), plane});
      }
      const PlaneMetrics metrics = MeasurePlanes(planes, matches, true_planes);
      errors.plane_angle_deg = metrics.mean_angle_deg;
      errors.plane_offset_m = metrics.mean_offset_m;
    }
    report->trace.push_back(errors);
  }
}

// Plane labels come with the model, or with simplified.ply of its run folder:
// the faces of mesh.obj may be in another order. Returns the matches.
std::vector<PlaneMatch> EvaluatePlanes(const TexturedMesh& model,
                                       ModelReport* report) {
  const fs::path folder = report->model;
  if (!fs::is_directory(folder) || !fs::exists(folder / "planes.json")) {
    AddWarning("'" + report->model +
               "' is no run folder with planes.json: its planes are not "
               "compared with the truth");
    return {};
  }
  MeshFile labelled_file{model.mesh, model.face_plane};
  if (labelled_file.face_plane.empty()) {
    labelled_file = ReadMesh((folder / "simplified.ply").string());
  }
  const MeshFile truth = ReadMesh(FLAGS_true_mesh);
  if (truth.face_plane.empty()) {
    throw InputError(FLAGS_true_mesh +
                     " has no plane_id for each face: give the labelled mesh "
                     "that belongs to --true_planes");
  }
  const std::vector<NumberedPlane> true_planes = ReadPlanes(FLAGS_true_planes);
  const LabelledMesh labelled{&labelled_file.mesh, &labelled_file.face_plane};
  const LabelledMesh labelled_truth{&truth.mesh, &truth.face_plane};
  PlaneMetricsOptions options;
  options.seed = FLAGS_seed;
  const std::string file = (folder / "planes.json").string();
  const std::vector<PlaneMatch> matches =
      MatchPlanes(labelled, true_planes, labelled_truth, options);
  report->planes = MeasurePlanes(ReadPlanes(file), matches, true_planes);
  const std::vector<NumberedPlane> initial = ReadPlanes(file, true);
  if (!initial.empty()) {
    report->initial_planes = MeasurePlanes(initial, matches, true_planes);
  }
  return matches;
}

// "a.ply" -> "0_a_" so that several models do not overwrite each other.
std::string DumpPrefix(const std::string& model, size_t index, size_t count) {
  if (FLAGS_dump_images.empty()) return "";
  const std::string prefix =
      count == 1 ? ""
                 : std::to_string(index) + "_" +
                       fs::path(model).filename().stem().string() + "_";
  return (fs::path(FLAGS_dump_images) / prefix).string();
}

ModelReport EvaluateOne(const std::string& path,
                        const RgbdSequence* sequence,
                        const TriMesh* reference,
                        const std::string& dump_prefix) {
  const TexturedMesh model = LoadModel(path);
  ModelReport report;
  report.model = path;
  report.vertices = model.mesh.NumVertices();
  report.faces = model.mesh.NumFaces();
  report.textured = !model.face_uv.empty();
  report.checks = CheckMesh(model.mesh);
  if (sequence != nullptr) {
    EvaluatePhotosAndPoses(*sequence, model, dump_prefix, &report);
  }
  if (reference != nullptr) {
    MeshDistanceOptions options;
    options.num_points = FLAGS_num_points;
    options.seed = FLAGS_seed;
    report.distance = CompareMeshes(model.mesh, *reference, options);
  }
  std::vector<PlaneMatch> matches;
  if (!FLAGS_true_planes.empty()) matches = EvaluatePlanes(model, &report);
  EvaluateTrace(sequence, matches, &report);
  return report;
}

void WriteReport(const std::vector<ModelReport>& reports) {
  nlohmann::json models = nlohmann::json::array();
  for (const ModelReport& report : reports) models.push_back(ToJson(report));
  const nlohmann::json file = {
      {"models", models},
      {"averaging", "mean over frames of each figure, PSNR in dB"},
      {"warnings", Warnings()}};
  WriteFileAtomically(FLAGS_output, file.dump(1) + "\n");
}

int Run() {
  CheckFlags();
  SetNumThreads(FLAGS_threads);
  const Stopwatch watch;
  std::unique_ptr<RgbdSequence> sequence;
  if (!FLAGS_sequence.empty()) sequence = OpenSequenceFromFlags();
  TexturedMesh reference;
  if (!FLAGS_reference_mesh.empty()) {
    reference = LoadModel(FLAGS_reference_mesh);
  }
  const std::vector<std::string> models = SplitAtCommas(FLAGS_model);
  std::vector<ModelReport> reports;
  for (size_t i = 0; i < models.size(); ++i) {
    reports.push_back(
        EvaluateOne(models[i],
                    sequence.get(),
                    FLAGS_reference_mesh.empty() ? nullptr : &reference.mesh,
                    DumpPrefix(models[i], i, models.size())));
    if (!reports.back().pose_source.empty()) {
      std::printf("%s: poses of the frames from %s\n",
                  models[i].c_str(),
                  reports.back().pose_source.c_str());
    }
  }
  std::printf("%s", FormatTables(reports).c_str());
  if (!FLAGS_output.empty()) WriteReport(reports);
  std::printf("\n%.1f s, peak %.0f MB\n", watch.WallSeconds(), PeakRssMb());
  return kExitOk;
}

}  // namespace
}  // namespace facet

int main(int argc, char** argv) {
  return facet::RunApp(
      argc,
      argv,
      {"Compares models with photos, with a reference mesh and with the "
       "truth.\n"
       "  facet-evaluate --model=RUN[,dense.ply] --sequence=DIR "
       "[--frames_stride=25 --frames_offset=7] [--reference_mesh=dense.ply] "
       "[--output=evaluation.json]",
       {}},
      facet::Run);
}
