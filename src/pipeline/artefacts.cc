// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "pipeline/artefacts.h"

#include <charconv>
#include <filesystem>
#include <sstream>

#include "costs/se3_manifold.h"
#include "util/archive.h"
#include "util/errors.h"

namespace facet {
namespace {

using nlohmann::json;

// Settings of all stages up to `stage`.
json SettingsUpTo(const ReconstructOptions& options, Stage stage) {
  json settings = json::object();
  for (int s = 0; s <= static_cast<int>(stage); ++s) {
    settings[StageName(static_cast<Stage>(s))] =
        StageSettings(options, static_cast<Stage>(s));
  }
  return settings;
}

// Numbers as a user would type them: gflags prints 0.03 with 17 digits.
std::string ShortNumber(const std::string& text) {
  double value = 0;
  const char* end = text.data() + text.size();
  const auto read = std::from_chars(text.data(), end, value);
  if (read.ec != std::errc() || read.ptr != end) return text;
  char out[32];
  return std::string(out, std::to_chars(out, out + sizeof(out), value).ptr);
}

// Artefacts do not depend on where they are written.
std::string WithoutOutput(const std::string& flags_text) {
  std::string kept;
  std::istringstream lines(flags_text);
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("--output=", 0) != 0) kept += line + "\n";
  }
  return kept;
}

// "--name=value" of the flag in the lines of a flags.txt, "" if it is not
// there.
std::string FlagLine(const std::string& flags_text, const std::string& name) {
  const std::string begin = "--" + name + "=";
  std::istringstream lines(flags_text);
  for (std::string line; std::getline(lines, line);) {
    if (line.compare(0, begin.size(), begin) != 0) continue;
    return begin + ShortNumber(line.substr(begin.size()));
  }
  return "";
}

// Throws OptionsError that names the first flag in which an artefact (`meta`)
// and the options differ, and both values.
void CheckSettings(const ReconstructOptions& options,
                   Stage stage,
                   const std::string& path,
                   const json& meta) {
  const json was = meta.value("settings", json::object());
  const json now = SettingsUpTo(options, stage);
  if (was == now) return;
  for (const auto& [name, settings] : now.items()) {
    for (const auto& [key, value] : settings.items()) {
      if (!was.contains(name) || !was[name].contains(key)) continue;
      if (was[name][key] == value) continue;
      const std::string flag = FlagOfSetting(key);
      std::string before = FlagLine(meta.value("flags", std::string()), flag);
      std::string after = FlagLine(options.flags_text, flag);
      if (before == after) {  // not a flag, or a file was replaced
        before = "--" + flag + " = " + was[name][key].dump();
        after = value.dump();
      }
      throw OptionsError(path + " was made with " + before + ", now it is " +
                         after + ": start again with --from_stage=" + name +
                         " or give the old value");
    }
  }
  throw OptionsError(path +
                     " was made by another version of facet: start again with "
                     "--from_stage=partition");
}

ArchiveReader Open(const ReconstructOptions& options, Stage stage) {
  const std::string path = ArtefactPath(options, stage);
  if (!std::filesystem::exists(path)) {
    throw InputError(path + " does not exist: run with --from_stage=" +
                     StageName(stage) + " or an earlier stage first");
  }
  ArchiveReader reader(path);
  CheckSettings(options, stage, path, reader.meta());
  return reader;
}

void Write(const ReconstructOptions& options,
           Stage stage,
           const StageRecord& record,
           ArchiveWriter* writer) {
  writer->meta["settings"] = SettingsUpTo(options, stage);
  writer->meta["flags"] = WithoutOutput(options.flags_text);
  writer->meta["report"] = record.report;
  writer->meta["warnings"] = record.warnings;
  writer->Write(ArtefactPath(options, stage));
}

void GetRecord(const ArchiveReader& reader, StageRecord* record) {
  record->report = reader.meta().value("report", json());
  record->warnings =
      reader.meta().value("warnings", std::vector<std::string>());
}

// Eigen's classes have constructors; archives want plain numbers.
std::vector<double> Flatten(const std::vector<Eigen::Vector3d>& points) {
  std::vector<double> flat;
  flat.reserve(3 * points.size());
  for (const Eigen::Vector3d& p : points) {
    flat.insert(flat.end(), {p.x(), p.y(), p.z()});
  }
  return flat;
}

std::vector<Eigen::Vector3d> Unflatten(const std::vector<double>& flat) {
  std::vector<Eigen::Vector3d> points(flat.size() / 3);
  for (size_t i = 0; i < points.size(); ++i) {
    points[i] = Eigen::Vector3d(flat[3 * i], flat[3 * i + 1], flat[3 * i + 2]);
  }
  return points;
}

std::vector<double> Flatten(const std::vector<Plane>& planes) {
  std::vector<double> flat;
  for (const Plane& p : planes) {
    flat.insert(flat.end(),
                {p.normal.x(), p.normal.y(), p.normal.z(), p.offset});
  }
  return flat;
}

std::vector<Plane> PlanesFrom(const std::vector<double>& flat) {
  std::vector<Plane> planes(flat.size() / 4);
  for (size_t i = 0; i < planes.size(); ++i) {
    planes[i].normal =
        Eigen::Vector3d(flat[4 * i], flat[4 * i + 1], flat[4 * i + 2]);
    planes[i].offset = flat[4 * i + 3];
  }
  return planes;
}

void AddMesh(const TriMesh& mesh, ArchiveWriter* writer) {
  writer->Add("vertices", Flatten(mesh.vertices));
  writer->Add("faces", mesh.faces);
  writer->Add("vertex_colors", mesh.vertex_colors);
}

TriMesh GetMesh(const ArchiveReader& reader) {
  TriMesh mesh;
  mesh.vertices = Unflatten(reader.Get<double>("vertices"));
  mesh.faces = reader.Get<std::array<int, 3>>("faces");
  mesh.vertex_colors = reader.Get<Rgb>("vertex_colors");
  return mesh;
}

constexpr size_t kClusterNumbers = 10;

std::vector<double> FlattenClusters(const std::vector<PlaneCluster>& clusters) {
  std::vector<double> flat;
  for (const PlaneCluster& c : clusters) {
    flat.insert(flat.end(),
                {c.plane.normal.x(),
                 c.plane.normal.y(),
                 c.plane.normal.z(),
                 c.plane.offset,
                 c.centroid.x(),
                 c.centroid.y(),
                 c.centroid.z(),
                 c.area,
                 c.rms,
                 static_cast<double>(c.num_faces)});
  }
  return flat;
}

std::vector<PlaneCluster> ClustersFrom(const std::vector<double>& flat) {
  std::vector<PlaneCluster> clusters(flat.size() / kClusterNumbers);
  for (size_t i = 0; i < clusters.size(); ++i) {
    const double* x = flat.data() + kClusterNumbers * i;
    PlaneCluster& c = clusters[i];
    c.plane.normal = Eigen::Vector3d(x[0], x[1], x[2]);
    c.plane.offset = x[3];
    c.centroid = Eigen::Vector3d(x[4], x[5], x[6]);
    c.area = x[7];
    c.rms = x[8];
    c.num_faces = static_cast<int>(x[9]);
  }
  return clusters;
}

}  // namespace

std::string ArtefactPath(const ReconstructOptions& options, Stage stage) {
  return options.output_path + "/stages/" + StageName(stage) + ".bin";
}

void Save(const ReconstructOptions& options,
          Stage stage,
          const MeshArtefact& artefact) {
  ArchiveWriter writer;
  AddMesh(artefact.mesh, &writer);
  writer.Add("face_cluster", artefact.partition.face_cluster);
  writer.Add("clusters", FlattenClusters(artefact.partition.clusters));
  writer.Add("refitted_planes", Flatten(artefact.refitted_planes));
  Write(options, stage, artefact, &writer);
}

MeshArtefact LoadMeshArtefact(const ReconstructOptions& options, Stage stage) {
  const ArchiveReader reader = Open(options, stage);
  MeshArtefact artefact;
  artefact.mesh = GetMesh(reader);
  artefact.partition.face_cluster = reader.Get<int>("face_cluster");
  artefact.partition.clusters = ClustersFrom(reader.Get<double>("clusters"));
  artefact.refitted_planes = PlanesFrom(reader.Get<double>("refitted_planes"));
  GetRecord(reader, &artefact);
  return artefact;
}

void Save(const ReconstructOptions& options, const KeyframeArtefact& artefact) {
  ArchiveWriter writer;
  writer.Add("keyframes", artefact.keyframes);
  writer.Add("blur", artefact.blur);
  Write(options, Stage::kKeyframes, artefact, &writer);
}

KeyframeArtefact LoadKeyframeArtefact(const ReconstructOptions& options) {
  const ArchiveReader reader = Open(options, Stage::kKeyframes);
  KeyframeArtefact artefact;
  artefact.keyframes = reader.Get<int>("keyframes");
  artefact.blur = reader.Get<double>("blur");
  GetRecord(reader, &artefact);
  return artefact;
}

void Save(const ReconstructOptions& options,
          const PhotometricArtefact& artefact) {
  ArchiveWriter writer;
  std::vector<double> poses(kPoseSize * artefact.cam_from_world.size());
  for (size_t k = 0; k < artefact.cam_from_world.size(); ++k) {
    PoseToBlock(artefact.cam_from_world[k], poses.data() + kPoseSize * k);
  }
  writer.Add("poses", poses);
  writer.Add("planes", Flatten(artefact.planes));
  writer.Add("warps", artefact.warps);
  const WarpLattice& l = artefact.lattice;
  writer.Add("lattice", std::vector<int>{l.columns, l.rows, l.width, l.height});
  std::vector<float> exposures;
  for (const Exposure& exposure : artefact.exposures) {
    exposures.insert(
        exposures.end(), exposure.gain.data(), exposure.gain.data() + 3);
    exposures.insert(
        exposures.end(), exposure.offset.data(), exposure.offset.data() + 3);
  }
  writer.Add("exposures", exposures);
  writer.Add("plane_texels", artefact.plane_texels);
  writer.Add("plane_frames", artefact.plane_frames);
  Write(options, Stage::kPhotometric, artefact, &writer);
}

PhotometricArtefact LoadPhotometricArtefact(const ReconstructOptions& options) {
  const ArchiveReader reader = Open(options, Stage::kPhotometric);
  PhotometricArtefact artefact;
  const std::vector<double> poses = reader.Get<double>("poses");
  for (size_t k = 0; k < poses.size() / kPoseSize; ++k) {
    const double* block = poses.data() + kPoseSize * k;
    Pose pose;  // its constructor would normalise again and change bits
    pose.rotation.coeffs() = Eigen::Map<const Eigen::Vector4d>(block);
    pose.translation = Eigen::Map<const Eigen::Vector3d>(block + 4);
    artefact.cam_from_world.push_back(pose);
  }
  artefact.planes = PlanesFrom(reader.Get<double>("planes"));
  artefact.warps = reader.Get<double>("warps");
  const std::vector<int> lattice = reader.Get<int>("lattice");
  artefact.lattice = {
      lattice.at(0), lattice.at(1), lattice.at(2), lattice.at(3)};
  const std::vector<float> exposures = reader.Get<float>("exposures");
  for (size_t i = 0; i + 6 <= exposures.size(); i += 6) {
    artefact.exposures.push_back(
        {Eigen::Map<const Eigen::Array3f>(exposures.data() + i),
         Eigen::Map<const Eigen::Array3f>(exposures.data() + i + 3)});
  }
  artefact.plane_texels = reader.Get<size_t>("plane_texels");
  artefact.plane_frames = reader.Get<size_t>("plane_frames");
  GetRecord(reader, &artefact);
  return artefact;
}

void Save(const ReconstructOptions& options, const GeometryArtefact& artefact) {
  ArchiveWriter writer;
  AddMesh(artefact.mesh, &writer);
  Write(options, Stage::kGeometry, artefact, &writer);
}

GeometryArtefact LoadGeometryArtefact(const ReconstructOptions& options) {
  const ArchiveReader reader = Open(options, Stage::kGeometry);
  GeometryArtefact artefact;
  artefact.mesh = GetMesh(reader);
  GetRecord(reader, &artefact);
  return artefact;
}

void SaveTraceStates(const ReconstructOptions& options,
                     const std::vector<int>& frame_numbers,
                     const TraceState& start,
                     const Trace& trace) {
  const std::string path = options.output_path + "/trace_states.bin";
  std::error_code ignored;
  std::filesystem::remove(path, ignored);
  if (!options.photometric.solver.trace_states) return;
  TraceStates states;
  states.keyframes = frame_numbers;
  states.states.push_back(start);
  for (const TraceRow& row : trace.rows) {
    states.states.push_back({row.cam_from_world, row.planes});
  }
  WriteTraceStates(path, states);
}

}  // namespace facet
