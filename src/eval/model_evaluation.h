// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// A model against chosen frames of a sequence: the metrics of
// photometric_metrics.h at the given and at the refined pose, and their means.
#pragma once

#include <string>
#include <vector>

#include "eval/frame_alignment.h"
#include "eval/photometric_metrics.h"
#include "rgbd/sequence.h"

namespace facet {

struct EvaluationFrame {
  int frame_idx = 0;  // into sequence.frames()
  int number = 0;
  Pose color_cam_from_world;
};

struct EvaluationOptions {
  double max_depth_difference_m = 0.05;  // mask of the metrics
  AlignmentOptions alignment;
  // Where to write photo | model | difference of every frame at the refined
  // pose, as <dump_prefix>frame-NNNNNN.png; empty = nowhere. The difference is
  // |photo - affine model| times 2.
  std::string dump_prefix;
};

struct FrameEvaluation {
  int number = 0;
  bool valid = false;  // has pixels in the mask
  ViewMetrics given;   // at the given pose
  // At the refined pose; the given one's values if that was rejected.
  ViewMetrics aligned;
  FrameAlignment alignment;
};

struct ModelEvaluation {
  std::vector<FrameEvaluation> frames;  // as asked for
  // Means over the valid frames of each figure (of PSNR in dB: the mean of the
  // frames' PSNR, not the PSNR of the mean error).
  ViewMetrics given, aligned;
  size_t valid_frames = 0, rejected_alignments = 0;
  double mean_shift_m = 0, mean_angle_deg = 0;  // of accepted alignments
};

// All frames in parallel; the result does not depend on the number of threads.
// Frames that cannot be read or that do not see the model count as not valid,
// with a warning. Throws InputError for a model without colours,
// UnsolvableError when no frame is valid.
ModelEvaluation EvaluateModel(const TexturedMesh& model,
                              const RgbdSequence& sequence,
                              const std::vector<EvaluationFrame>& frames,
                              const EvaluationOptions& options);

}  // namespace facet
