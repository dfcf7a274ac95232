// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Planes that start close to one of three orthogonal directions are drawn to
// it: most rooms are built that way (a Manhattan world; Coughlan and Yuille
// 1999).
#pragma once

#include <Eigen/Core>

#include "problems/term.h"
#include "terms/term_kinds.h"

namespace facet {

// The three directions as columns of a rotation: the largest plane, then the
// largest one across it, then the mean over all planes within 10 degrees of
// either, weighted by observed texels. Signs are arbitrary.
Eigen::Matrix3d EstimateAxes(const TermInput& input);

// A block for every observed plane within 5 degrees of an axis
// (costs/axis_plane.h). With weight 1, one degree off costs as much as an error
// of 0.05 in every intensity seen once.
Term MakeManhattanTerm(const TermInput& input, double weight);

}  // namespace facet
