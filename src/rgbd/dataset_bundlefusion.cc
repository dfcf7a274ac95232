// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "rgbd/dataset_bundlefusion.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <limits>
#include <map>
#include <mutex>

#include "rgbd/image_files.h"
#include "rgbd/pose_text.h"
#include "util/atomic_file.h"
#include "util/errors.h"
#include "util/warnings.h"

namespace facet {
namespace {

namespace fs = std::filesystem;

// More broken poses than this and the files mean something else.
constexpr double kMaxBrokenShare = 0.2;
// Images tried before the sizes are believed.
constexpr int kMaxProbes = 10;

struct FrameFiles {
  std::string color, depth, pose;
};

// "frame-000012.color.jpg" -> 12, "color.jpg". False for other names.
bool ParseFrameName(const std::string& name, int* number, std::string* rest) {
  const std::string prefix = "frame-";
  if (name.compare(0, prefix.size(), prefix) != 0) return false;
  size_t end = prefix.size();
  while (end < name.size() && std::isdigit(name[end])) ++end;
  const size_t digits = end - prefix.size();
  if (digits == 0 || digits > 9 || end >= name.size() || name[end] != '.') {
    return false;
  }
  *number = std::stoi(name.substr(prefix.size(), digits));
  *rest = name.substr(end + 1);
  return true;
}

std::map<int, FrameFiles> ListFrames(const std::string& path) {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(path)) {
    names.push_back(entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  std::map<int, FrameFiles> frames;
  for (const std::string& name : names) {
    int number;
    std::string rest;
    if (!ParseFrameName(name, &number, &rest)) continue;
    const std::string file = path + "/" + name;
    // In sorted order a lossless .png comes after and wins over .jpg.
    if (rest == "color.jpg" || rest == "color.png") {
      frames[number].color = file;
    } else if (rest == "depth.pgm" || rest == "depth.png") {
      frames[number].depth = file;
    } else if (rest == "pose.txt") {
      frames[number].pose = file;
    }
  }
  return frames;
}

PoseState ReadPoseFile(const std::string& path, Pose* pose) {
  std::vector<double> numbers;
  if (!ParseNumbers(ReadFile(path), &numbers) || numbers.size() != 16) {
    return PoseState::kNotRigid;
  }
  return ReadRigid(RowMajor4x4(numbers.data()), pose);
}

std::string Count(size_t count, const std::string& what, size_t of) {
  return std::to_string(count) + " of " + std::to_string(of) + " frames " +
         what;
}

class BundleFusionSequence : public RgbdSequence {
 public:
  BundleFusionSequence(const std::string& path,
                       const SequenceOptions& options) {
    path_ = path;
    options_ = options;
    const std::map<int, FrameFiles> files = ListFrames(path);
    if (files.empty()) {
      const bool below = fs::is_directory(path + "/frames");
      throw InputError("no files frame-NNNNNN.* in '" + path + "'" +
                       (below ? ": did you mean '" + path + "/frames'?"
                              : ": give the folder that holds the frames"));
    }
    ReadCalibration(files);
    ReadFrames(files);
    CheckSizes();
  }

  cv::Mat LoadColor(int frame_idx) const override {
    const std::string& file = frames_[frame_idx].color_path;
    cv::Mat color = ReadColorImage(file);
    CheckSize(color, calibration_.color, file);
    return color;
  }

  cv::Mat LoadLuma(int frame_idx) const override {
    const std::string& file = frames_[frame_idx].color_path;
    const cv::Mat bytes = ReadLumaImage(file);
    CheckSize(bytes, calibration_.color, file);
    cv::Mat luma;
    bytes.convertTo(luma, CV_32F, 1.0 / 255);
    return luma;
  }

  cv::Mat LoadDepth(int frame_idx) const override {
    return DepthWithin(frame_idx, options_.min_depth_m, options_.max_depth_m);
  }

  cv::Mat LoadDepthOfAnyRange(int frame_idx) const override {
    return DepthWithin(frame_idx, 0, std::numeric_limits<double>::infinity());
  }

 private:
  cv::Mat DepthWithin(int frame_idx, double min_m, double max_m) const {
    const cv::Mat raw = RawDepth(frame_idx);
    const cv::Mat depth =
        DepthInMetres(raw, calibration_.depth_shift, min_m, max_m);
    ReleasePages(raw);
    return depth;
  }

  cv::Mat RawDepth(int frame_idx) const {
    if (options_.keep_depth) {
      const std::lock_guard<std::mutex> lock(kept_mutex_);
      const auto kept = kept_depth_.find(frame_idx);
      if (kept != kept_depth_.end()) return kept->second;
    }
    const std::string& file = frames_[frame_idx].depth_path;
    cv::Mat raw = ReadRawDepthImage(file);
    CheckSize(raw, calibration_.depth, file);
    if (options_.keep_depth) {
      raw = depth_store_.Keep(raw);
      const std::lock_guard<std::mutex> lock(kept_mutex_);
      kept_depth_.emplace(frame_idx, raw);
    }
    return raw;
  }

  static void CheckSize(const cv::Mat& image,
                        const Pinhole& camera,
                        const std::string& file) {
    if (image.cols == camera.width && image.rows == camera.height) return;
    throw InputError(
        "image '" + file + "' has " + std::to_string(image.cols) + "x" +
        std::to_string(image.rows) + " pixels but the calibration says " +
        std::to_string(camera.width) + "x" + std::to_string(camera.height) +
        ": correct sizes and intrinsics in info.txt, or rescale the images");
  }

  void ReadCalibration(const std::map<int, FrameFiles>& files) {
    SensorInfo sensor;
    if (fs::exists(path_ + "/info.txt")) {
      sensor = ReadSensorInfo(path_ + "/info.txt");
    } else if (fs::exists(path_ + "/_info.txt")) {
      sensor = ReadSensorInfo(path_ + "/_info.txt");
    } else {
      sensor = SensorFromIntrinsics(files);
    }
    calibration_.color = sensor.color;
    calibration_.depth = sensor.depth;
    calibration_.depth_shift = sensor.depth_shift;
    const Pose color(sensor.color_extrinsic), depth(sensor.depth_extrinsic);
    calibration_.color_from_depth =
        options_.extrinsic_direction == ExtrinsicDirection::kRigToCam
            ? color * depth.Inverse()
            : color.Inverse() * depth;
  }

  // No info.txt: one matrix for both images, sizes from the images.
  SensorInfo SensorFromIntrinsics(
      const std::map<int, FrameFiles>& files) const {
    const std::string file = path_ + "/camera-intrinsics.txt";
    if (!fs::exists(file)) {
      throw InputError("no info.txt, _info.txt or camera-intrinsics.txt in '" +
                       path_ +
                       "': write the 3x3 matrix of the camera to "
                       "camera-intrinsics.txt, or an info.txt");
    }
    std::vector<double> k;
    if (!ParseNumbers(ReadFile(file), &k) || k.size() != 9 || !(k[0] > 0) ||
        !(k[4] > 0)) {
      throw InputError("'" + file +
                       "' must be a 3x3 matrix of 9 numbers with positive "
                       "focal lengths: correct the file");
    }
    SensorInfo sensor;
    sensor.color = sensor.depth = Pinhole{k[0], k[4], k[2], k[5], 0, 0};
    ProbeSizes(files, &sensor.color, &sensor.depth);
    if (sensor.color.width != sensor.depth.width ||
        sensor.color.height != sensor.depth.height) {
      throw InputError("colour and depth images in '" + path_ +
                       "' differ in size, one camera-intrinsics.txt cannot "
                       "describe both: write an info.txt");
    }
    return sensor;
  }

  void ProbeSizes(const std::map<int, FrameFiles>& files,
                  Pinhole* color,
                  Pinhole* depth) const {
    std::string problem = "no frame has both images";
    int probes = 0;
    for (const auto& [number, frame] : files) {
      if (frame.color.empty() || frame.depth.empty()) continue;
      if (++probes > kMaxProbes) break;
      try {
        const cv::Mat c = ReadColorImage(frame.color);
        const cv::Mat d = ReadRawDepthImage(frame.depth);
        color->width = c.cols;
        color->height = c.rows;
        depth->width = d.cols;
        depth->height = d.rows;
        return;
      } catch (const InputError& e) {
        problem = e.what();
      }
    }
    throw InputError("cannot find the image sizes of '" + path_ +
                     "': " + problem);
  }

  void ReadFrames(const std::map<int, FrameFiles>& files) {
    size_t missing = 0, lost = 0, broken = 0, with_pose = 0;
    std::string first_broken;
    const Pose depth_from_pose_camera =
        options_.pose_camera == PoseCamera::kColor
            ? calibration_.color_from_depth.Inverse()
            : Pose();
    for (const auto& [number, file] : files) {
      Frame frame;
      frame.number = number;
      frame.color_path = file.color;
      frame.depth_path = file.depth;
      if (file.color.empty() || file.depth.empty() || file.pose.empty()) {
        ++missing;
        frame.usable = false;
      }
      if (!file.pose.empty()) {
        ++with_pose;
        Pose world_from_cam;
        const PoseState state = ReadPoseFile(file.pose, &world_from_cam);
        if (state != PoseState::kRigid) frame.usable = false;
        if (state == PoseState::kLost) ++lost;
        if (state == PoseState::kNotRigid && broken++ == 0) {
          first_broken = file.pose;
        }
        if (state == PoseState::kRigid) {
          frame.depth_cam_from_world =
              depth_from_pose_camera * world_from_cam.Inverse();
        }
      }
      frames_.push_back(frame);
    }
    Report(missing, lost, broken, with_pose, first_broken);
  }

  void Report(size_t missing,
              size_t lost,
              size_t broken,
              size_t with_pose,
              const std::string& first_broken) const {
    if (broken > kMaxBrokenShare * with_pose) {
      throw InputError(std::to_string(broken) + " of " +
                       std::to_string(with_pose) +
                       " poses are not rigid 4x4 matrices in row-major order, "
                       "first '" +
                       first_broken + "': correct the pose files");
    }
    const auto is_usable = [](const Frame& frame) { return frame.usable; };
    if (std::none_of(frames_.begin(), frames_.end(), is_usable)) {
      throw InputError("no usable frame in '" + path_ + "': of " +
                       std::to_string(frames_.size()) + " frames " +
                       std::to_string(missing) +
                       " lack an image or a pose file and " +
                       std::to_string(lost) + " have a lost pose");
    }
    const size_t n = frames_.size();
    if (missing > 0) {
      AddWarning(Count(missing, "lack an image or a pose file: not used", n));
    }
    if (lost > 0) AddWarning(Count(lost, "have a lost pose: not used", n));
    if (broken > 0) {
      AddWarning(Count(broken, "have a pose that is not rigid (first '", n) +
                 first_broken + "'): not used");
    }
  }

  // Says early what would fail at every frame.
  void CheckSizes() const {
    int probes = 0;
    std::string problem;
    for (size_t i = 0; i < frames_.size() && probes < kMaxProbes; ++i) {
      if (!frames_[i].usable) continue;
      ++probes;
      cv::Mat color, raw;
      try {
        color = ReadColorImage(frames_[i].color_path);
        raw = ReadRawDepthImage(frames_[i].depth_path);
      } catch (const InputError& e) {
        problem = e.what();
        continue;
      }
      CheckSize(color, calibration_.color, frames_[i].color_path);
      CheckSize(raw, calibration_.depth, frames_[i].depth_path);
      return;
    }
    throw InputError(problem);
  }

  mutable std::mutex kept_mutex_;
  mutable std::map<int, cv::Mat> kept_depth_;  // by frame
};

}  // namespace

std::unique_ptr<RgbdSequence> OpenBundleFusionFolder(
    const std::string& path, const SequenceOptions& options) {
  return std::make_unique<BundleFusionSequence>(path, options);
}

}  // namespace facet
