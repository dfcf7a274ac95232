// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "eval/trajectory_error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "util/errors.h"

namespace facet {
namespace {

constexpr double kRadToDeg = 57.29577951308232;

struct MatchedPose {
  int number = 0;
  Pose estimated, truth;  // world_from_cam
};

std::vector<MatchedPose> Match(const std::vector<NumberedPose>& estimated,
                               const std::vector<NumberedPose>& truth) {
  std::map<int, Pose> true_by_number;
  for (const NumberedPose& p : truth) {
    true_by_number[p.number] = p.world_from_cam;
  }
  std::vector<MatchedPose> matched;
  for (const NumberedPose& p : estimated) {
    const auto it = true_by_number.find(p.number);
    if (it != true_by_number.end()) {
      matched.push_back({p.number, p.world_from_cam, it->second});
    }
  }
  std::sort(matched.begin(), matched.end(), [](const auto& a, const auto& b) {
    return a.number < b.number;
  });
  return matched;
}

// Pairs of consecutive entries (gap 0), or of entries `gap` numbers apart.
RelativeError ComparePairs(const std::vector<MatchedPose>& poses, int gap) {
  std::vector<double> translation, rotation;
  size_t j = 0;
  for (size_t i = 0; i < poses.size(); ++i) {
    if (gap == 0) {
      j = i + 1;
    } else {
      while (j < poses.size() && poses[j].number < poses[i].number + gap) ++j;
      if (j < poses.size() && poses[j].number != poses[i].number + gap)
        continue;
    }
    if (j >= poses.size()) break;
    const Pose true_motion = poses[i].truth.Inverse() * poses[j].truth;
    const Pose motion = poses[i].estimated.Inverse() * poses[j].estimated;
    const Pose error = true_motion.Inverse() * motion;
    translation.push_back(error.translation.norm());
    rotation.push_back(RotationAngle(error) * kRadToDeg);
  }
  return {Summarize(translation), Summarize(rotation)};
}

}  // namespace

ErrorSummary Summarize(std::vector<double> errors) {
  ErrorSummary summary;
  summary.count = errors.size();
  if (errors.empty()) {
    summary.rmse = summary.mean = summary.median = summary.max =
        std::numeric_limits<double>::quiet_NaN();
    return summary;
  }
  double sum = 0, squares = 0;
  for (const double e : errors) {
    sum += e;
    squares += e * e;
  }
  const double n = static_cast<double>(errors.size());
  summary.mean = sum / n;
  summary.rmse = std::sqrt(squares / n);
  std::sort(errors.begin(), errors.end());
  const size_t half = errors.size() / 2;
  summary.median = errors.size() % 2 == 1
                       ? errors[half]
                       : 0.5 * (errors[half - 1] + errors[half]);
  summary.max = errors.back();
  return summary;
}

TrajectoryError CompareTrajectories(const std::vector<NumberedPose>& estimated,
                                    const std::vector<NumberedPose>& truth,
                                    double frames_per_second) {
  const std::vector<MatchedPose> poses = Match(estimated, truth);
  if (poses.empty()) {
    throw InputError(
        "the true poses and the poses to be judged have no frame number in "
        "common: are they of the same scan?");
  }
  TrajectoryError result;
  result.matched = poses.size();
  Eigen::Matrix3Xd from(3, poses.size()), to(3, poses.size());
  std::vector<Pose> estimated_cam, true_cam;
  for (size_t i = 0; i < poses.size(); ++i) {
    from.col(i) = poses[i].estimated.translation;
    to.col(i) = poses[i].truth.translation;
    estimated_cam.push_back(poses[i].estimated.Inverse());
    true_cam.push_back(poses[i].truth.Inverse());
  }
  Pose true_from_estimated;
  if (poses.size() >= 3) true_from_estimated = AlignPoints(from, to);
  std::vector<double> ate, absolute, rotation;
  for (const MatchedPose& p : poses) {
    const Pose aligned = true_from_estimated * p.estimated;
    ate.push_back((aligned.translation - p.truth.translation).norm());
    absolute.push_back((p.estimated.translation - p.truth.translation).norm());
    rotation.push_back(RotationAngle(p.truth.Inverse() * aligned) * kRadToDeg);
  }
  result.ate = Summarize(ate);
  result.absolute = Summarize(absolute);
  result.rotation = Summarize(rotation);
  result.frame = ComparePairs(poses, 0);
  result.second = ComparePairs(
      poses, std::max(1, static_cast<int>(std::lround(frames_per_second))));
  result.slide = CommonMotion(true_cam, estimated_cam);
  return result;
}

}  // namespace facet
