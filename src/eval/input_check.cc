// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "eval/input_check.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "render/ray_scene.h"
#include "util/errors.h"

namespace facet {
namespace {

// Shifts closer than this share are one reading.
constexpr double kSameShift = 0.02;
// Another reading must agree in this many times more pixels to win over the
// one given: near the origin, inverse poses fit a little, too.
constexpr double kClearlyBetter = 1.5;
// A reading that covers less of the depth is no evidence.
constexpr double kMinCoverage = 0.02;
// More faces than this seen from behind and the mesh is inside out. Fused
// meshes show few, open ones of other programs may be mixed.
constexpr double kMaxBehindShare = 0.9;

// Subsampled sensor depth of a frame, in the unit of the calibration given.
struct SampledFrame {
  int frame_idx = 0;
  std::vector<float> depth;  // row-major, 0 = missing
};

// The camera of every `step`-th pixel: its pixel i is pixel i * step.
Pinhole EveryNthPixel(const Pinhole& camera, int step) {
  const double s = step;
  return {camera.fx / s,
          camera.fy / s,
          camera.cx / s,
          camera.cy / s,
          (camera.width + step - 1) / step,
          (camera.height + step - 1) / step};
}

std::vector<SampledFrame> SampleFrames(const RgbdSequence& sequence,
                                       const InputCheckOptions& options) {
  std::vector<int> usable;
  for (size_t i = 0; i < sequence.frames().size(); ++i) {
    if (sequence.frames()[i].usable) usable.push_back(static_cast<int>(i));
  }
  const size_t count =
      std::min<size_t>(std::max(options.num_frames, 1), usable.size());
  std::vector<SampledFrame> frames;
  std::string problem = "no usable frame in '" + sequence.path() + "'";
  for (size_t k = 0; k < count; ++k) {
    SampledFrame frame;
    frame.frame_idx = usable[(2 * k + 1) * usable.size() / (2 * count)];
    cv::Mat depth;
    try {
      depth = sequence.LoadDepthOfAnyRange(frame.frame_idx);
    } catch (const InputError& e) {
      problem = e.what();
      continue;
    }
    for (int y = 0; y < depth.rows; y += options.pixel_step) {
      for (int x = 0; x < depth.cols; x += options.pixel_step) {
        frame.depth.push_back(depth.at<float>(y, x));
      }
    }
    frames.push_back(std::move(frame));
  }
  if (frames.empty()) throw InputError(problem);
  return frames;
}

Pose DepthCamFromWorld(const RgbdSequence& sequence,
                       int frame_idx,
                       const Reading& reading) {
  Pose in_file =
      sequence.PoseFileFromColorCam(sequence.color_cam_from_world(frame_idx));
  if (reading.inverse_pose) in_file = in_file.Inverse();
  if (reading.opengl_axes) {
    // Half a turn about x: y and z change sign.
    in_file =
        in_file * Pose(Eigen::Quaterniond(0, 1, 0, 0), Eigen::Vector3d::Zero());
  }
  return sequence.calibration().color_from_depth.Inverse() *
         sequence.ColorCamFromPoseFile(in_file);
}

// Pairs of sensor depth (as given) and mesh depth, over all frames.
struct DepthPairs {
  size_t depth_pixels = 0;
  std::vector<std::pair<float, float>> sensor_mesh;  // where both are there
};

DepthPairs Compare(const RgbdSequence& sequence,
                   const std::vector<SampledFrame>& frames,
                   const RayScene& scene,
                   const InputCheckOptions& options,
                   const Reading& poses) {
  const Pinhole camera =
      EveryNthPixel(sequence.calibration().depth, options.pixel_step);
  DepthPairs pairs;
  for (const SampledFrame& frame : frames) {
    const DepthRender render = RenderDepth(
        scene, camera, DepthCamFromWorld(sequence, frame.frame_idx, poses));
    for (size_t i = 0; i < frame.depth.size(); ++i) {
      if (frame.depth[i] <= 0) continue;
      ++pairs.depth_pixels;
      if (render.depth[i] > 0) {
        pairs.sensor_mesh.emplace_back(frame.depth[i], render.depth[i]);
      }
    }
  }
  return pairs;
}

// The shift under which half of the sensor depth lies before the mesh.
double EstimateShift(const DepthPairs& pairs, double given_shift) {
  std::vector<double> ratios;
  for (const auto& [sensor, mesh] : pairs.sensor_mesh) {
    ratios.push_back(sensor / mesh);
  }
  const auto median = ratios.begin() + ratios.size() / 2;
  std::nth_element(ratios.begin(), median, ratios.end());
  return given_shift * *median;
}

void AddReadings(const DepthPairs& pairs,
                 double given_shift,
                 double tolerance_m,
                 Reading reading,
                 std::vector<Reading>* readings) {
  std::vector<double> shifts = {given_shift};
  const auto add = [&shifts](double shift) {
    for (const double known : shifts) {
      if (std::abs(shift / known - 1) < kSameShift) return false;
    }
    shifts.push_back(shift);
    return true;
  };
  for (const double shift : {1000.0, 5000.0, 256.0}) add(shift);
  const size_t num_fixed = shifts.size();
  if (!pairs.sensor_mesh.empty()) add(EstimateShift(pairs, given_shift));

  reading.depth_pixels = pairs.depth_pixels;
  reading.hits = pairs.sensor_mesh.size();
  for (size_t i = 0; i < shifts.size(); ++i) {
    reading.depth_shift = shifts[i];
    reading.estimated_shift = i >= num_fixed;
    const double scale = given_shift / shifts[i];
    reading.agreeing = 0;
    for (const auto& [sensor, mesh] : pairs.sensor_mesh) {
      if (std::abs(scale * sensor - mesh) < tolerance_m) ++reading.agreeing;
    }
    readings->push_back(reading);
  }
}

double BehindShare(const RgbdSequence& sequence,
                   const std::vector<SampledFrame>& frames,
                   const RayScene& scene,
                   const TriMesh& mesh,
                   const InputCheckOptions& options,
                   const Reading& poses) {
  const Pinhole camera =
      EveryNthPixel(sequence.calibration().depth, options.pixel_step);
  size_t hits = 0, behind = 0;
  for (const SampledFrame& frame : frames) {
    const Pose cam_from_world =
        DepthCamFromWorld(sequence, frame.frame_idx, poses);
    const Eigen::Vector3d center = cam_from_world.CenterInSource();
    for (const int f : RenderDepth(scene, camera, cam_from_world).face) {
      if (f < 0) continue;
      ++hits;
      const Eigen::Vector3d view = mesh.FaceCentroid(f) - center;
      if (mesh.FaceCross(f).dot(view) > 0) ++behind;
    }
  }
  return hits > 0 ? static_cast<double>(behind) / static_cast<double>(hits) : 0;
}

std::string Percent(double share) {
  char text[32];
  std::snprintf(text, sizeof(text), "%.0f %%", 100 * share);
  return text;
}

bool Fits(const Reading& reading, const InputCheckOptions& options) {
  return reading.Agreement() >= options.min_agreement &&
         reading.Coverage() >= kMinCoverage;
}

// What to change so that `best` becomes the reading given.
std::string Remedy(const Reading& given, const Reading& best) {
  std::string remedy;
  const auto append = [&remedy](const std::string& text) {
    if (!remedy.empty()) remedy += ", and ";
    remedy += text;
  };
  if (best.inverse_pose) {
    append(
        "the pose files hold world-to-camera matrices: replace each by its "
        "inverse");
  }
  if (best.opengl_axes) {
    append(
        "the pose files belong to a camera with y up and z backward: multiply "
        "each camera-to-world matrix by diag(1, -1, -1, 1) from the right");
  }
  if (best.depth_shift != given.depth_shift) {
    char text[160];
    std::snprintf(text,
                  sizeof(text),
                  "the depth images have %s%.4g units a metre, not %.4g: "
                  "correct m_depthShift in info.txt",
                  best.estimated_shift ? "about " : "",
                  best.depth_shift,
                  given.depth_shift);
    append(text);
  }
  return remedy;
}

void Judge(const InputCheckOptions& options, InputCheck* check) {
  const Reading& given = check->readings[0];
  size_t most = given.agreeing;
  for (size_t i = 1; i < check->readings.size(); ++i) {
    const Reading& reading = check->readings[i];
    if (reading.agreeing > most && Fits(reading, options)) {
      most = reading.agreeing;
      check->best = static_cast<int>(i);
    }
  }
  const Reading& best = check->readings[check->best];
  check->given_fits =
      Fits(given, options) &&
      static_cast<double>(best.agreeing) <= kClearlyBetter * given.agreeing;
  if (check->given_fits) {
    check->best = 0;
    check->verdict =
        "The given conventions fit: " + Percent(given.Agreement()) +
        " of the depth on the mesh agrees with it.";
  } else if (check->best != 0) {
    check->verdict = "The given conventions do not fit (" +
                     Percent(given.Agreement()) + " agree), but with " +
                     Percent(best.Agreement()) + ": " + Remedy(given, best) +
                     ".";
  } else {
    check->verdict =
        "No convention fits (at best as given, " + Percent(given.Agreement()) +
        " agree): check that mesh and poses are of the same scan, in the same "
        "world frame and in metres, and the intrinsics of the depth camera.";
  }
}

}  // namespace

double Reading::Coverage() const {
  return depth_pixels > 0 ? static_cast<double>(hits) / depth_pixels : 0;
}

double Reading::Agreement() const {
  return hits > 0 ? static_cast<double>(agreeing) / hits : 0;
}

std::string DescribePoses(const Reading& reading) {
  return std::string(reading.inverse_pose ? "inverse pose" : "pose as given") +
         (reading.opengl_axes ? ", OpenGL axes" : "");
}

InputCheck CheckInput(const RgbdSequence& sequence,
                      const TriMesh& mesh,
                      const InputCheckOptions& options) {
  const std::vector<SampledFrame> frames = SampleFrames(sequence, options);
  InputCheck check;
  size_t pixels = 0;
  for (const SampledFrame& frame : frames) {
    check.frames.push_back(frame.frame_idx);
    pixels += frame.depth.size();
  }
  const RayScene scene(mesh);
  const double shift = sequence.calibration().depth_shift;
  for (const bool opengl_axes : {false, true}) {
    for (const bool inverse_pose : {false, true}) {
      Reading reading;
      reading.inverse_pose = inverse_pose;
      reading.opengl_axes = opengl_axes;
      const DepthPairs pairs =
          Compare(sequence, frames, scene, options, reading);
      if (pairs.depth_pixels == 0) {
        throw UnsolvableError("the depth images of '" + sequence.path() +
                              "' that were read hold no depth at all");
      }
      AddReadings(pairs, shift, options.tolerance_m, reading, &check.readings);
    }
  }
  check.depth_share = static_cast<double>(check.readings[0].depth_pixels) /
                      static_cast<double>(pixels);
  Judge(options, &check);
  check.behind_share = BehindShare(
      sequence, frames, scene, mesh, options, check.readings[check.best]);
  if (check.behind_share > kMaxBehindShare) {
    check.given_fits = false;
    check.verdict += " The mesh is inside out (" + Percent(check.behind_share) +
                     " is seen from behind): reverse the corners of its faces.";
  }
  return check;
}

}  // namespace facet
