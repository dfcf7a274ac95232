// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "ablate/scans.h"

#include <cctype>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "util/atomic_file.h"
#include "util/errors.h"

namespace facet {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

// Rotations are off by about this much more where centres are off by 1 mm.
constexpr double kDegreesPerMm = 0.04;

std::string ShortNumber(double value) {
  char text[40];
  std::snprintf(text, sizeof(text), "%g", value);
  return text;
}

class ScanReader {
 public:
  explicit ScanReader(const std::string& path)
      : path_(path), folder_(fs::absolute(path).parent_path()) {}

  std::vector<ScanSpec> Read() const {
    json file;
    try {
      file = json::parse(ReadFile(path_));
    } catch (const json::exception& e) {
      throw InputError(path_ + " is no JSON: " + e.what());
    }
    if (!file.is_array() || file.empty()) {
      throw InputError(path_ + " must be a list of scans: " + kExample);
    }
    std::vector<ScanSpec> scans;
    for (const json& entry : file) {
      const ScanSpec scan = ReadOne(entry, scans.size());
      for (const ScanSpec& other : scans) {
        if (other.name == scan.name) {
          throw InputError(path_ + ": two scans are called '" + scan.name +
                           "'");
        }
      }
      scans.push_back(scan);
    }
    return scans;
  }

 private:
  static constexpr const char* kExample =
      "[{\"name\": \"kitchen\", \"sequence\": \"kitchen/frames\", \"mesh\": "
      "\"kitchen/dense.ply\"}]";

  ScanSpec ReadOne(const json& entry, size_t index) const {
    const std::string where = path_ + ", scan " + std::to_string(index + 1);
    if (!entry.is_object()) {
      throw InputError(where + ": not an object: " + kExample);
    }
    ScanSpec scan;
    for (const auto& [key, value] : entry.items()) {
      if (std::string* text = TextOf(key, &scan)) {
        if (!value.is_string()) {
          throw InputError(where + ": \"" + key + "\" must be a text");
        }
        *text = IsPath(key) ? Absolute(value) : value.get<std::string>();
      } else if (double* number = NumberOf(key, &scan)) {
        if (!value.is_number()) {
          throw InputError(where + ": \"" + key + "\" must be a number");
        }
        *number = value;
      } else {
        throw InputError(where + ": unknown key \"" + key +
                         "\": use name, group, sequence, mesh, true_poses, "
                         "true_planes, true_mesh, flags, seed, noise_mm, "
                         "noise_deg");
      }
    }
    Check(where, &scan);
    return scan;
  }

  static std::string* TextOf(const std::string& key, ScanSpec* scan) {
    if (key == "name") return &scan->name;
    if (key == "group") return &scan->group;
    if (key == "flags") return &scan->flags;
    if (key == "sequence") return &scan->sequence;
    if (key == "mesh") return &scan->mesh;
    if (key == "true_poses") return &scan->true_poses;
    if (key == "true_planes") return &scan->true_planes;
    if (key == "true_mesh") return &scan->true_mesh;
    return nullptr;
  }

  static double* NumberOf(const std::string& key, ScanSpec* scan) {
    if (key == "seed") return &scan->seed;
    if (key == "noise_mm") return &scan->noise_mm;
    if (key == "noise_deg") return &scan->noise_deg;
    return nullptr;
  }

  static bool IsPath(const std::string& key) {
    return key != "name" && key != "group" && key != "flags";
  }

  static void Check(const std::string& where, ScanSpec* scan) {
    if (scan->name.empty() || scan->sequence.empty() || scan->mesh.empty()) {
      throw InputError(where + ": name, sequence and mesh must be there");
    }
    for (const char c : scan->name) {
      if (std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_') {
        continue;
      }
      throw InputError(where + ": the name '" + scan->name +
                       "' may have letters, digits, - and _ only");
    }
    if (scan->group.empty()) scan->group = scan->name;
    if (scan->true_planes.empty() != scan->true_mesh.empty()) {
      throw InputError(where + ": true_planes and true_mesh need each other");
    }
    for (const std::string* path : {&scan->sequence,
                                    &scan->mesh,
                                    &scan->true_poses,
                                    &scan->true_planes,
                                    &scan->true_mesh}) {
      if (!path->empty() && !fs::exists(*path)) {
        throw InputError(where + ": " + *path + " does not exist");
      }
    }
  }

  std::string Absolute(const std::string& path) const {
    return path.empty() ? "" : (folder_ / path).lexically_normal().string();
  }

  const std::string path_;
  const fs::path folder_;
};

}  // namespace

std::vector<ScanSpec> ReadScans(const std::string& path) {
  return ScanReader(path).Read();
}

std::vector<ScanSpec> SyntheticScans(const std::vector<int>& seeds,
                                     const std::vector<double>& noise_mm,
                                     const std::vector<double>& noise_deg,
                                     const std::string& folder) {
  if (!noise_deg.empty() && noise_deg.size() != noise_mm.size()) {
    throw OptionsError("--noise_deg must have as many values as --noise_mm");
  }
  std::vector<ScanSpec> scans;
  for (size_t level = 0; level < noise_mm.size(); ++level) {
    for (const int seed : seeds) {
      ScanSpec scan;
      scan.synthetic = true;
      scan.seed = seed;
      scan.noise_mm = noise_mm[level];
      scan.noise_deg = noise_deg.empty() ? kDegreesPerMm * noise_mm[level]
                                         : noise_deg[level];
      scan.group = "room " + ShortNumber(scan.noise_mm) + " mm " +
                   ShortNumber(scan.noise_deg) + " deg";
      scan.name = "room_" + ShortNumber(scan.noise_mm) + "mm_" +
                  ShortNumber(scan.noise_deg) + "deg_seed" +
                  std::to_string(seed);
      const fs::path base = fs::absolute(folder).lexically_normal() / scan.name;
      scan.sequence = base / "sequence";
      scan.mesh = base / "dense.ply";
      scan.true_poses = base / "sequence/poses_true.txt";
      scan.true_planes = base / "sequence/planes_true.json";
      scan.true_mesh = base / "sequence/mesh_true.ply";
      scans.push_back(scan);
    }
  }
  return scans;
}

}  // namespace facet
