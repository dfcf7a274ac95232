// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Observations of a keyframe by the cell of its warp lattice: those of a cell
// touch the same parameters, and so become one block (costs/frame_cell_cost.h).
#pragma once

#include <cstdint>
#include <vector>

#include "problems/texture_problem.h"

namespace facet {

struct CellBins {
  std::vector<size_t> begin;  // cells + 1, WarpLattice::CellIndex
  std::vector<uint32_t> ids;  // texels, cell by cell
};

// `points` are plane points about the origin (PlanePoints), projected with the
// pose as it is now. `one_bin`: all in one, for keyframes without warp.
CellBins BinByCell(const TextureProblem& problem,
                   const std::vector<PhotoTexel>& points,
                   const Pose& cam_from_world,
                   int keyframe,
                   bool one_bin);

}  // namespace facet
