// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The files of a synthetic scan.
#include <cstdio>
#include <filesystem>
#include <iterator>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "mesh/mesh_io.h"
#include "rgbd/trajectory_io.h"
#include "synth/synth_scan.h"
#include "util/atomic_file.h"
#include "util/errors.h"
#include "util/parallel_for.h"
#include "util/progress.h"

namespace facet {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;

std::string MatrixText(const Eigen::Matrix4d& m, char row_end) {
  std::string text;
  char number[40];
  for (int r = 0; r < 4; ++r) {
    for (int c = 0; c < 4; ++c) {
      std::snprintf(number, sizeof(number), "%.12g", m(r, c));
      text += number;
      text += c < 3 ? ' ' : row_end;
    }
  }
  return text;
}

std::string IntrinsicText(const Pinhole& camera) {
  Eigen::Matrix4d m = Eigen::Matrix4d::Identity();
  m(0, 0) = camera.fx;
  m(1, 1) = camera.fy;
  m(0, 2) = camera.cx;
  m(1, 2) = camera.cy;
  return MatrixText(m, ' ');
}

std::string InfoText(const SynthScan& scan) {
  const RgbdCalibration& c = scan.calibration;
  const Eigen::Matrix4d identity = Eigen::Matrix4d::Identity();
  std::string text = "m_versionNumber = 4\nm_sensorName = facet synthetic\n";
  const auto add = [&](const std::string& key, const std::string& value) {
    text += key + " = " + value + "\n";
  };
  add("m_colorWidth", std::to_string(c.color.width));
  add("m_colorHeight", std::to_string(c.color.height));
  add("m_depthWidth", std::to_string(c.depth.width));
  add("m_depthHeight", std::to_string(c.depth.height));
  add("m_depthShift", std::to_string(static_cast<int>(c.depth_shift)));
  add("m_calibrationColorIntrinsic", IntrinsicText(c.color));
  add("m_calibrationColorExtrinsic",
      MatrixText(c.color_from_depth.Matrix(), ' '));
  add("m_calibrationDepthIntrinsic", IntrinsicText(c.depth));
  add("m_calibrationDepthExtrinsic", MatrixText(identity, ' '));
  add("m_frames.size", std::to_string(scan.true_poses.size()));
  return text;
}

std::string PlanesJson(const SynthRoom& room) {
  std::vector<double> areas(room.surfaces.size(), 0);
  std::vector<Vector3d> sums(room.surfaces.size(), Vector3d::Zero());
  for (size_t f = 0; f < room.mesh.NumFaces(); ++f) {
    const double area = room.mesh.FaceArea(f);
    areas[room.face_surface[f]] += area;
    sums[room.face_surface[f]] += area * room.mesh.FaceCentroid(f);
  }
  nlohmann::ordered_json planes = nlohmann::ordered_json::array();
  for (size_t i = 0; i < room.surfaces.size(); ++i) {
    const RoomSurface& surface = room.surfaces[i];
    if (surface.curved) continue;
    const Vector3d& n = surface.plane.normal;
    const Vector3d centroid = sums[i] / areas[i];
    planes.push_back({{"id", i},
                      {"name", surface.name},
                      {"normal", {n.x(), n.y(), n.z()}},
                      {"offset", surface.plane.offset},
                      {"centroid", {centroid.x(), centroid.y(), centroid.z()}},
                      {"area", areas[i]}});
  }
  return nlohmann::ordered_json({{"planes", planes}}).dump(1) + "\n";
}

void WriteImage(const std::string& path,
                const std::string& extension,
                const cv::Mat& image,
                const std::vector<int>& parameters) {
  std::vector<uint8_t> bytes;
  if (!cv::imencode(extension, image, bytes, parameters)) {
    throw InputError("cannot encode '" + path + "'");
  }
  WriteFileAtomically(path, std::string(bytes.begin(), bytes.end()));
}

void WriteFrame(const SynthScan& scan, const std::string& path, int i) {
  char name[40];
  std::snprintf(name, sizeof(name), "/frame-%06d.", i);
  const std::string stem = path + name;
  cv::Mat color = RenderSynthColor(scan, i);
  for (cv::Vec3b& p : cv::Mat_<cv::Vec3b>(color)) std::swap(p[0], p[2]);
  WriteImage(stem + "color.jpg", ".jpg", color, {cv::IMWRITE_JPEG_QUALITY, 95});
  WriteImage(stem + "depth.png",
             ".png",
             RenderSynthDepth(scan, i),
             {cv::IMWRITE_PNG_COMPRESSION, 3});
  WriteFileAtomically(stem + "pose.txt",
                      MatrixText(scan.given_poses[i].Inverse().Matrix(), '\n'));
}

// Creates the folder, or removes the frames in it.
void PrepareFolder(const std::string& path) {
  std::error_code error;
  fs::create_directories(path, error);
  if (error) {
    throw InputError("cannot create folder '" + path + "': " + error.message());
  }
  std::vector<fs::path> old;
  for (const auto& entry : fs::directory_iterator(path)) {
    const std::string name = entry.path().filename().string();
    if (name.rfind("frame-", 0) == 0) old.push_back(entry.path());
  }
  for (const auto& file : old) fs::remove(file, error);
}

}  // namespace

void CheckSynthOutput(const std::string& path, bool overwrite) {
  std::error_code error;
  if (fs::exists(path, error) && !fs::is_directory(path, error)) {
    throw OptionsError("output '" + path +
                       "' is a file: name a folder instead");
  }
  if (!overwrite && fs::is_directory(path, error) &&
      !fs::is_empty(path, error)) {
    throw OptionsError("output '" + path +
                       "' is not empty: choose another folder or pass "
                       "--overwrite");
  }
}

void WriteSynthSequence(const SynthScan& scan,
                        const std::string& path,
                        bool overwrite) {
  CheckSynthOutput(path, overwrite);
  PrepareFolder(path);
  WriteFileAtomically(path + "/info.txt", InfoText(scan));
  std::vector<NumberedPose> poses;
  for (size_t i = 0; i < scan.true_poses.size(); ++i) {
    poses.push_back({static_cast<int>(i), scan.true_poses[i].Inverse()});
  }
  WritePoses(path + "/poses_true.txt", poses);
  WriteFileAtomically(path + "/planes_true.json", PlanesJson(scan.room));
  WritePly(path + "/mesh_true.ply", scan.room.mesh, &scan.room.face_plane);
  Progress progress("frames", scan.true_poses.size());
  ParallelFor(0, scan.true_poses.size(), [&](size_t i) {
    WriteFrame(scan, path, static_cast<int>(i));
    progress.Add();
  });
}

}  // namespace facet
