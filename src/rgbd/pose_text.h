// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Numbers and rigid motions in text files, with the odd spellings found in
// published scans (method, Sec. 1.1 and 1.2).
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "geometry/pose.h"

namespace facet {

// The white-space separated numbers of `text`. Knows nan, inf and the forms
// "1.#INF", "-1.#IND", "1.#QNAN" of old Windows programs, which stream
// extraction refuses. False if a token is not a number; `numbers` then holds
// those before it.
bool ParseNumbers(const std::string& text, std::vector<double>* numbers);

enum class PoseState {
  kRigid,     // a rotation (det 1) and a translation, row 3 is 0 0 0 1
  kLost,      // a non-finite entry, or all zeros: tracking was lost
  kNotRigid,  // |R^T R - I| or |det R - 1| above 1e-2, or another last row
};

// Judges a 4x4 matrix; if rigid, `pose` receives it with the rotation replaced
// by the nearest one (SVD): text files carry 6 to 8 digits.
PoseState ReadRigid(const Eigen::Matrix4d& matrix, Pose* pose);

// Row-major 4x4 from 16 numbers.
Eigen::Matrix4d RowMajor4x4(const double* numbers);

// The upper three rows' and last row's 16 numbers, row-major, separated by
// blanks, 12 significant digits.
std::string FormatPose(const Pose& pose);

}  // namespace facet
