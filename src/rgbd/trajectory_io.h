// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Camera trajectories as text, and the way corrections of a few frames carry
// over to all of them.
#pragma once

#include <string>
#include <vector>

#include "geometry/pose.h"

namespace facet {

struct NumberedPose {
  int number = 0;  // frame number as in the file names
  Pose world_from_cam;
};

// poses.txt: one line a frame, the frame number, then the 16 numbers of the
// camera-to-world matrix, row-major, separated by blanks. Lines that are empty
// or start with # are skipped. Written atomically, 12 significant digits.
void WritePoses(const std::string& path,
                const std::vector<NumberedPose>& poses);

// Throws InputError naming file and line: missing file, not 17 numbers, a pose
// that is not rigid, a frame number twice, no pose at all. In file order.
std::vector<NumberedPose> ReadPoses(const std::string& path);

// Redwood / Open3D .log: per frame a line of three integers (number, number,
// number + 1) and four lines of the camera-to-world matrix. Readers of this
// format count frames by their order in the file.
void WriteRedwoodLog(const std::string& path,
                     const std::vector<NumberedPose>& poses);

// Carries the corrections of keyframes over to all frames (method, Sec. 11.2).
// With the left correction of keyframe k,
//
//   D_k = T_k' T_k^-1,   T = cam_from_world,
//
// frame i between keyframes a and b gets T_i' = D(s) T_i, where
// s = (number_i - number_a) / (number_b - number_a), D(s) has the slerp of the
// rotations and the linear interpolation of the translations. Before the first
// and after the last keyframe D stays constant. Keyframes get exactly T_k'.
//
//   numbers         ascending frame numbers
//   cam_from_world  the poses T_i before, one a number
//   keyframes       ascending indices into both, not empty
//   corrected       the poses T_k' after, one a keyframe
std::vector<Pose> PropagateCorrections(const std::vector<int>& numbers,
                                       const std::vector<Pose>& cam_from_world,
                                       const std::vector<int>& keyframes,
                                       const std::vector<Pose>& corrected);

}  // namespace facet
