// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "rgbd/keyframes.h"

#include <cmath>
#include <limits>

#include "rgbd/blur.h"
#include "util/errors.h"
#include "util/parallel_for.h"
#include "util/progress.h"
#include "util/warnings.h"

namespace facet {
namespace {

// More undecodable images than this and the scan is damaged as a whole.
constexpr double kMaxUnreadableShare = 0.2;

void CheckOptions(const KeyframeOptions& options) {
  if (options.window < 1) {
    throw OptionsError("keyframe_window must be at least 1");
  }
  if (options.holdout_stride < 0 || options.holdout_offset < 0) {
    throw OptionsError(
        "holdout_stride and holdout_offset must not be negative");
  }
}

double FrameBlur(const RgbdSequence& sequence, int frame_idx) {
  const cv::Mat luma = sequence.LoadLuma(frame_idx);
  return CreteBlur({luma.ptr<float>(),
                    luma.cols,
                    luma.rows,
                    static_cast<ptrdiff_t>(luma.step1())});
}

void ReportUnreadable(const std::vector<std::string>& problems, size_t tried) {
  size_t count = 0;
  std::string first;
  for (const std::string& problem : problems) {
    if (!problem.empty() && count++ == 0) first = problem;
  }
  if (count == 0) return;
  const std::string sentence = std::to_string(count) + " of " +
                               std::to_string(tried) +
                               " frames cannot be read, the first: " + first;
  if (count > kMaxUnreadableShare * tried) throw InputError(sentence);
  AddWarning(sentence + ": skipped");
}

// The sharpest candidate with a blur in every window.
std::vector<int> SharpestInWindows(const std::vector<Frame>& frames,
                                   const std::vector<int>& candidates,
                                   const std::vector<double>& blurs,
                                   int window_size) {
  std::vector<int> keyframes;
  int last_window = -1;
  for (const int i : candidates) {
    if (std::isnan(blurs[i])) continue;
    const int window = frames[i].number / window_size;
    if (window != last_window) {
      keyframes.push_back(i);
      last_window = window;
    } else if (blurs[i] < blurs[keyframes.back()]) {
      keyframes.back() = i;
    }
  }
  return keyframes;
}

// Why the depth image cannot be used; "" if it can.
std::string DepthProblem(const RgbdSequence& sequence, int frame_idx) {
  try {
    sequence.LoadDepth(frame_idx);
    return "";
  } catch (const InputError& e) {
    return e.what();
  }
}

}  // namespace

bool IsHeldOut(int frame_number, const KeyframeOptions& options) {
  const int stride = options.holdout_stride;
  return stride > 0 && frame_number % stride == options.holdout_offset % stride;
}

std::vector<int> SelectKeyframes(const RgbdSequence& sequence,
                                 const KeyframeOptions& options,
                                 std::vector<double>* blur) {
  CheckOptions(options);
  const std::vector<Frame>& frames = sequence.frames();
  std::vector<int> candidates;
  for (size_t i = 0; i < frames.size(); ++i) {
    if (frames[i].usable && !IsHeldOut(frames[i].number, options)) {
      candidates.push_back(static_cast<int>(i));
    }
  }

  std::vector<double> blurs(frames.size(),
                            std::numeric_limits<double>::quiet_NaN());
  std::vector<std::string> problems(candidates.size());
  Progress progress("keyframes", candidates.size());
  ParallelFor(0, candidates.size(), [&](size_t i) {
    try {
      blurs[candidates[i]] = FrameBlur(sequence, candidates[i]);
    } catch (const InputError& e) {
      problems[i] = e.what();
    }
    progress.Add();
  });

  // The next sharpest steps in for a keyframe whose depth cannot be read. Only
  // keyframes need depth: each is decoded once.
  std::vector<int> keyframes;
  std::vector<bool> depth_read(frames.size(), false);
  for (bool complete = false; !complete;) {
    keyframes = SharpestInWindows(frames, candidates, blurs, options.window);
    std::vector<int> unread;
    for (const int k : keyframes) {
      if (!depth_read[k]) unread.push_back(k);
    }
    std::vector<std::string> depth_problems(unread.size());
    ParallelFor(0, unread.size(), [&](size_t i) {
      depth_problems[i] = DepthProblem(sequence, unread[i]);
    });
    complete = true;
    for (size_t i = 0; i < unread.size(); ++i) {
      depth_read[unread[i]] = true;
      if (depth_problems[i].empty()) continue;
      problems.push_back(depth_problems[i]);
      blurs[unread[i]] = std::numeric_limits<double>::quiet_NaN();
      complete = false;
    }
  }
  ReportUnreadable(problems, candidates.size());
  if (keyframes.empty()) {
    throw UnsolvableError(
        "no keyframe in '" + sequence.path() +
        "': every usable frame is held out or unreadable, lower the share "
        "held out");
  }
  if (blur != nullptr) *blur = std::move(blurs);
  return keyframes;
}

}  // namespace facet
