// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "rgbd/keyframes.h"

#include <cmath>
#include <limits>
#include <utility>

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

std::vector<int> Candidates(const std::vector<Frame>& frames,
                            const KeyframeOptions& options) {
  std::vector<int> candidates;
  for (size_t i = 0; i < frames.size(); ++i) {
    if (frames[i].usable && !IsHeldOut(frames[i].number, options)) {
      candidates.push_back(static_cast<int>(i));
    }
  }
  return candidates;
}

double FrameBlur(const RgbdSequence& sequence, int frame_idx) {
  const cv::Mat luma = sequence.LoadLuma(frame_idx);
  return CreteBlur({luma.ptr<float>(),
                    luma.cols,
                    luma.rows,
                    static_cast<ptrdiff_t>(luma.step1())});
}

void ReportUnreadable(const std::vector<std::string>& problems, size_t tried) {
  const size_t count = problems.size();
  if (count == 0) return;
  const std::string sentence =
      std::to_string(count) + " of " + std::to_string(tried) +
      " frames cannot be read, the first: " + problems.front();
  if (count > kMaxUnreadableShare * tried) throw InputError(sentence);
  AddWarning(sentence + ": skipped");
}

// Fills in the blur of the candidates.
void MeasureBlur(const RgbdSequence& sequence,
                 const std::vector<int>& candidates,
                 KeyframeChoice* choice) {
  choice->blur.assign(sequence.frames().size(),
                      std::numeric_limits<double>::quiet_NaN());
  std::vector<std::string> problems(candidates.size());
  Progress progress("keyframes", candidates.size());
  ParallelFor(0, candidates.size(), [&](size_t i) {
    try {
      choice->blur[candidates[i]] = FrameBlur(sequence, candidates[i]);
    } catch (const InputError& e) {
      problems[i] = e.what();
    }
    progress.Add();
  });
  for (std::string& problem : problems) {
    if (!problem.empty()) choice->problems.push_back(std::move(problem));
  }
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

KeyframeChoice ChooseKeyframes(const RgbdSequence& sequence,
                               const KeyframeOptions& options) {
  CheckOptions(options);
  const std::vector<Frame>& frames = sequence.frames();
  const std::vector<int> candidates = Candidates(frames, options);
  KeyframeChoice choice;
  choice.tried = candidates.size();
  MeasureBlur(sequence, candidates, &choice);
  // The next sharpest steps in for a keyframe whose depth cannot be read. Only
  // keyframes need depth: each is decoded once.
  std::vector<bool> depth_read(frames.size(), false);
  for (bool complete = false; !complete;) {
    choice.keyframes =
        SharpestInWindows(frames, candidates, choice.blur, options.window);
    std::vector<int> unread;
    for (const int k : choice.keyframes) {
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
      choice.problems.push_back(depth_problems[i]);
      choice.blur[unread[i]] = std::numeric_limits<double>::quiet_NaN();
      complete = false;
    }
  }
  return choice;
}

void CheckKeyframes(const RgbdSequence& sequence,
                    const KeyframeChoice& choice) {
  ReportUnreadable(choice.problems, choice.tried);
  if (choice.keyframes.empty()) {
    throw UnsolvableError(
        "no keyframe in '" + sequence.path() +
        "': every usable frame is held out or unreadable, lower the share "
        "held out");
  }
}

std::vector<int> SelectKeyframes(const RgbdSequence& sequence,
                                 const KeyframeOptions& options) {
  KeyframeChoice choice = ChooseKeyframes(sequence, options);
  CheckKeyframes(sequence, choice);
  return std::move(choice.keyframes);
}

}  // namespace facet
