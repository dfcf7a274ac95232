// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "eval/model_evaluation.h"

#include <cmath>
#include <cstdio>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "rgbd/depth.h"
#include "texture/model_io.h"
#include "util/atomic_file.h"
#include "util/errors.h"
#include "util/parallel_for.h"
#include "util/progress.h"
#include "util/warnings.h"

namespace facet {
namespace {

constexpr size_t kMinMaskPixels = 100;

// Every figure of ViewMetrics that has a mean over frames.
constexpr double ViewMetrics::*kFigures[] = {&ViewMetrics::coverage,
                                             &ViewMetrics::agreement,
                                             &ViewMetrics::psnr,
                                             &ViewMetrics::psnr_affine,
                                             &ViewMetrics::psnr_strict,
                                             &ViewMetrics::psnr_strict_affine,
                                             &ViewMetrics::ssim,
                                             &ViewMetrics::ssim_affine,
                                             &ViewMetrics::gradient_ncc,
                                             &ViewMetrics::gradient_energy,
                                             &ViewMetrics::depth_error_mean,
                                             &ViewMetrics::depth_error_median};

// The mean of each figure over the valid frames; frames where a figure is not
// defined (a view without any gradient) do not take part in it.
ViewMetrics MeanOf(const std::vector<FrameEvaluation>& frames,
                   ViewMetrics FrameEvaluation::*member) {
  ViewMetrics mean;
  for (const FrameEvaluation& frame : frames) {
    mean.depth_pixels += (frame.*member).depth_pixels;
    mean.mask_pixels += (frame.*member).mask_pixels;
  }
  for (const auto figure : kFigures) {
    double sum = 0;
    size_t count = 0;
    for (const FrameEvaluation& frame : frames) {
      const double value = (frame.*member).*figure;
      if (!frame.valid || !std::isfinite(value)) continue;
      sum += value;
      ++count;
    }
    mean.*figure = count > 0 ? sum / static_cast<double>(count) : std::nan("");
  }
  return mean;
}

void WritePicture(const std::string& prefix,
                  int number,
                  const cv::Mat& photo,
                  const ModelView& view,
                  const cv::Mat& mask) {
  cv::Mat photo_color, difference, stacked, bytes, bgr;
  photo.convertTo(photo_color, CV_32F);
  const cv::Mat corrected = ApplyAffineColor(
      FitAffineColor(view.color, photo_color, mask), view.color);
  cv::absdiff(photo_color, corrected, difference);
  difference = 2 * difference;
  difference.setTo(cv::Scalar::all(0), mask == 0);
  cv::hconcat(std::vector<cv::Mat>{photo_color, view.color, difference},
              stacked);
  stacked.convertTo(bytes, CV_8U);
  cv::cvtColor(bytes, bgr, cv::COLOR_RGB2BGR);
  char name[32];
  std::snprintf(name, sizeof(name), "frame-%06d.png", number);
  WriteFileAtomically(prefix + name, [&](const std::string& path) {
    if (!cv::imwrite(path, bgr)) {
      throw InputError("cannot write the picture '" + path + "'");
    }
  });
}

FrameEvaluation EvaluateFrame(const TexturedMesh& model,
                              const RayScene& scene,
                              const RgbdSequence& sequence,
                              const EvaluationFrame& frame,
                              const EvaluationOptions& options) {
  const Pinhole& camera = sequence.calibration().color;
  FrameEvaluation result;
  result.number = frame.number;
  const cv::Mat photo = sequence.LoadColor(frame.frame_idx);
  const cv::Mat depth = WarpDepthToColor(sequence.LoadDepth(frame.frame_idx),
                                         sequence.calibration());
  ModelView view = RenderView(model, scene, camera, frame.color_cam_from_world);
  result.given =
      CompareView(view, photo, depth, options.max_depth_difference_m);
  result.aligned = result.given;
  result.valid = result.given.mask_pixels >= kMinMaskPixels;
  if (!result.valid) return result;
  result.alignment = AlignFrame(model,
                                scene,
                                camera,
                                frame.color_cam_from_world,
                                photo,
                                depth,
                                options.alignment);
  if (result.alignment.accepted) {
    view = RenderView(model, scene, camera, result.alignment.cam_from_world);
    result.aligned =
        CompareView(view, photo, depth, options.max_depth_difference_m);
  }
  if (!options.dump_prefix.empty()) {
    WritePicture(
        options.dump_prefix,
        frame.number,
        photo,
        view,
        AgreementMask(view.depth, depth, options.max_depth_difference_m));
  }
  return result;
}

void Summarise(ModelEvaluation* result) {
  size_t accepted = 0;
  for (const FrameEvaluation& frame : result->frames) {
    if (!frame.valid) continue;
    ++result->valid_frames;
    if (!frame.alignment.accepted) {
      ++result->rejected_alignments;
      continue;
    }
    ++accepted;
    result->mean_shift_m += frame.alignment.shift_m;
    result->mean_angle_deg += frame.alignment.angle_deg;
  }
  if (accepted > 0) {
    result->mean_shift_m /= static_cast<double>(accepted);
    result->mean_angle_deg /= static_cast<double>(accepted);
  }
  result->given = MeanOf(result->frames, &FrameEvaluation::given);
  result->aligned = MeanOf(result->frames, &FrameEvaluation::aligned);
}

}  // namespace

ModelEvaluation EvaluateModel(const TexturedMesh& model,
                              const RgbdSequence& sequence,
                              const std::vector<EvaluationFrame>& frames,
                              const EvaluationOptions& options) {
  if (!HasColor(model)) {
    throw InputError(
        "the model has neither a texture nor vertex colours: there is nothing "
        "to compare with photos");
  }
  const RayScene scene(model.mesh);
  ModelEvaluation result;
  result.frames.resize(frames.size());
  std::vector<std::string> problems(frames.size());
  Progress progress("evaluating", frames.size());
  ParallelFor(0, frames.size(), [&](size_t i) {
    result.frames[i].number = frames[i].number;
    try {
      result.frames[i] =
          EvaluateFrame(model, scene, sequence, frames[i], options);
      if (!result.frames[i].valid) problems[i] = "it does not see the model";
    } catch (const InputError& e) {
      problems[i] = e.what();
    }
    progress.Add();
  });
  Summarise(&result);
  if (result.valid_frames < frames.size()) {
    size_t first = 0;
    while (problems[first].empty()) ++first;
    const std::string sentence =
        std::to_string(frames.size() - result.valid_frames) + " of " +
        std::to_string(frames.size()) +
        " frames cannot be evaluated, the first is frame " +
        std::to_string(frames[first].number) + ": " + problems[first];
    if (result.valid_frames == 0) throw UnsolvableError(sentence);
    AddWarning(sentence);
  }
  if (result.valid_frames == 0) {
    throw UnsolvableError("no frame to evaluate was chosen");
  }
  return result;
}

}  // namespace facet
