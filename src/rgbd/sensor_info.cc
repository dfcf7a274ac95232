// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Reader of info.txt.
#include <cmath>
#include <map>
#include <sstream>
#include <vector>

#include "rgbd/dataset_bundlefusion.h"
#include "rgbd/pose_text.h"
#include "util/atomic_file.h"
#include "util/errors.h"
#include "util/text.h"
#include "util/warnings.h"

namespace facet {
namespace {

constexpr int kMaxImageSize = 1 << 15;  // [px], beyond it the file is damaged

class KeyValues {
 public:
  explicit KeyValues(const std::string& path) : path_(path) {
    std::istringstream lines(ReadFile(path));
    std::string line;
    while (std::getline(lines, line)) {
      const size_t equals = line.find('=');
      if (equals == std::string::npos) continue;
      values_[std::string(Trim(line.substr(0, equals)))] =
          std::string(Trim(line.substr(equals + 1)));
    }
  }

  bool Has(const std::string& key) const { return values_.count(key) > 0; }

  std::vector<double> Numbers(const std::string& key, size_t count) const {
    const auto it = values_.find(key);
    if (it == values_.end()) Fail(key, "is missing");
    std::vector<double> numbers;
    if (!ParseNumbers(it->second, &numbers) || numbers.size() != count) {
      Fail(key,
           "must be " + std::to_string(count) +
               (count == 1 ? " number" : " numbers"));
    }
    for (const double number : numbers) {
      if (!std::isfinite(number)) Fail(key, "is not finite");
    }
    return numbers;
  }

  [[noreturn]] void Fail(const std::string& key,
                         const std::string& problem) const {
    throw InputError("'" + key + "' in '" + path_ + "' " + problem +
                     ": correct the file");
  }

 private:
  std::string path_;
  std::map<std::string, std::string> values_;
};

int ReadSize(const KeyValues& info, const std::string& key) {
  const double size = info.Numbers(key, 1)[0];
  if (size < 2 || size > kMaxImageSize || size != std::floor(size)) {
    info.Fail(key, "is not a number of pixels");
  }
  return static_cast<int>(size);
}

// `kind` is Color or Depth.
Pinhole ReadPinhole(const KeyValues& info,
                    const std::string& path,
                    const std::string& kind,
                    const std::string& lower_kind) {
  const std::string key = "m_calibration" + kind + "Intrinsic";
  const std::vector<double> k = info.Numbers(key, 16);
  Pinhole camera{k[0], k[5], k[2], k[6], 0, 0};
  camera.width = ReadSize(info, "m_" + lower_kind + "Width");
  camera.height = ReadSize(info, "m_" + lower_kind + "Height");
  if (camera.fx <= 0 || camera.fy <= 0) {
    info.Fail(key, "has a focal length that is not positive");
  }
  if (!camera.Contains({camera.cx, camera.cy})) {
    AddWarning("the principal point of " + key + " in '" + path +
               "' lies outside the image: check sizes and intrinsics");
  }
  return camera;
}

Eigen::Matrix4d ReadExtrinsic(const KeyValues& info,
                              const std::string& path,
                              const std::string& key) {
  if (!info.Has(key)) {
    AddWarning("'" + key + "' is missing in '" + path + "': taken as identity");
    return Eigen::Matrix4d::Identity();
  }
  const std::vector<double> numbers = info.Numbers(key, 16);
  Pose pose;
  if (ReadRigid(RowMajor4x4(numbers.data()), &pose) != PoseState::kRigid) {
    info.Fail(key, "is not a rigid motion");
  }
  return pose.Matrix();
}

}  // namespace

SensorInfo ReadSensorInfo(const std::string& path) {
  const KeyValues info(path);
  SensorInfo sensor;
  sensor.color = ReadPinhole(info, path, "Color", "color");
  sensor.depth = ReadPinhole(info, path, "Depth", "depth");
  sensor.color_extrinsic =
      ReadExtrinsic(info, path, "m_calibrationColorExtrinsic");
  sensor.depth_extrinsic =
      ReadExtrinsic(info, path, "m_calibrationDepthExtrinsic");
  if (info.Has("m_depthShift")) {
    sensor.depth_shift = info.Numbers("m_depthShift", 1)[0];
    if (sensor.depth_shift <= 0) {
      info.Fail("m_depthShift", "is not positive");
    }
  } else {
    AddWarning("'m_depthShift' is missing in '" + path +
               "': depth is taken as millimetres");
  }
  return sensor;
}

}  // namespace facet
