// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "rgbd/trajectory_io.h"

#include <glog/logging.h>

#include <cmath>
#include <cstdlib>
#include <set>
#include <sstream>

#include "rgbd/pose_text.h"
#include "util/atomic_file.h"
#include "util/errors.h"

namespace facet {
namespace {

NumberedPose ParseLine(const std::string& line, const std::string& where) {
  std::vector<double> numbers;
  if (!ParseNumbers(line, &numbers) || numbers.size() != 17 ||
      numbers[0] != std::floor(numbers[0]) || std::abs(numbers[0]) > 1e9) {
    throw InputError(where +
                     " must be a frame number and the 16 numbers of a matrix: "
                     "correct the file");
  }
  NumberedPose pose;
  pose.number = static_cast<int>(numbers[0]);
  if (ReadRigid(RowMajor4x4(&numbers[1]), &pose.world_from_cam) !=
      PoseState::kRigid) {
    throw InputError(where +
                     " is not a rigid camera-to-world matrix: correct the "
                     "file");
  }
  return pose;
}

}  // namespace

void WritePoses(const std::string& path,
                const std::vector<NumberedPose>& poses) {
  std::string text;
  for (const NumberedPose& pose : poses) {
    text += std::to_string(pose.number) + " " +
            FormatPose(pose.world_from_cam) + "\n";
  }
  WriteFileAtomically(path, text);
}

std::vector<NumberedPose> ReadPoses(const std::string& path) {
  std::istringstream lines(ReadFile(path));
  std::vector<NumberedPose> poses;
  std::set<int> seen;
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    const size_t begin = line.find_first_not_of(" \t\r");
    if (begin == std::string::npos || line[begin] == '#') continue;
    const std::string where =
        "line " + std::to_string(number) + " of '" + path + "'";
    poses.push_back(ParseLine(line, where));
    if (!seen.insert(poses.back().number).second) {
      throw InputError(where + " repeats frame number " +
                       std::to_string(poses.back().number) +
                       ": correct the file");
    }
  }
  if (poses.empty()) throw InputError("no poses in '" + path + "'");
  return poses;
}

void WriteRedwoodLog(const std::string& path,
                     const std::vector<NumberedPose>& poses) {
  std::string text;
  for (const NumberedPose& pose : poses) {
    const std::string number = std::to_string(pose.number);
    text +=
        number + " " + number + " " + std::to_string(pose.number + 1) + "\n";
    std::istringstream numbers(FormatPose(pose.world_from_cam));
    std::string value;
    for (int i = 0; numbers >> value; ++i) {
      text += value + (i % 4 == 3 ? "\n" : " ");
    }
  }
  WriteFileAtomically(path, text);
}

std::vector<Pose> PropagateCorrections(const std::vector<int>& numbers,
                                       const std::vector<Pose>& cam_from_world,
                                       const std::vector<int>& keyframes,
                                       const std::vector<Pose>& corrected) {
  CHECK_EQ(numbers.size(), cam_from_world.size());
  CHECK_EQ(keyframes.size(), corrected.size());
  CHECK(!keyframes.empty());
  std::vector<Pose> corrections(keyframes.size());
  for (size_t k = 0; k < keyframes.size(); ++k) {
    corrections[k] = corrected[k] * cam_from_world[keyframes[k]].Inverse();
  }
  std::vector<Pose> result(cam_from_world.size());
  size_t next = 0;  // first keyframe at or after frame i
  for (size_t i = 0; i < result.size(); ++i) {
    while (next < keyframes.size() && keyframes[next] < static_cast<int>(i)) {
      ++next;
    }
    if (next < keyframes.size() && keyframes[next] == static_cast<int>(i)) {
      result[i] = corrected[next];
    } else if (next == 0) {
      result[i] = corrections.front() * cam_from_world[i];
    } else if (next == keyframes.size()) {
      result[i] = corrections.back() * cam_from_world[i];
    } else {
      const Pose &a = corrections[next - 1], &b = corrections[next];
      const double before = numbers[keyframes[next - 1]];
      const double s =
          (numbers[i] - before) / (numbers[keyframes[next]] - before);
      result[i] = Pose(a.rotation.slerp(s, b.rotation),
                       (1 - s) * a.translation + s * b.translation) *
                  cam_from_world[i];
    }
  }
  return result;
}

}  // namespace facet
