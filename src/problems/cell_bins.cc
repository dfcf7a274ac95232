// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "problems/cell_bins.h"

namespace facet {

CellBins BinByCell(const TextureProblem& problem,
                   const std::vector<PhotoTexel>& points,
                   const Pose& cam_from_world,
                   int keyframe,
                   bool one_bin) {
  const uint32_t* ids =
      problem.observations.texel.data() + problem.observations.begin[keyframe];
  const size_t n = problem.observations.begin[keyframe + 1] -
                   problem.observations.begin[keyframe];
  CellBins bins;
  if (one_bin) {
    bins.begin = {0, n};
    bins.ids.assign(ids, ids + n);
    return bins;
  }
  const Eigen::Matrix3d r = cam_from_world.RotationMatrix();
  const Eigen::Vector3d t = cam_from_world * problem.origin;
  std::vector<uint16_t> cell(n);
  bins.begin.assign(problem.lattice.NumCells() + 1, 0);
  for (size_t i = 0; i < n; ++i) {
    const PhotoTexel& texel = points[ids[i]];
    const Eigen::Vector3d y =
        r * Eigen::Vector3d(texel.x, texel.y, texel.z) + t;
    const Eigen::Vector2d u = problem.camera.Project<double>(y);
    const WarpCell where = problem.lattice.Locate(u.x(), u.y());
    cell[i] =
        static_cast<uint16_t>(problem.lattice.CellIndex(where.a, where.b));
    ++bins.begin[cell[i] + 1];
  }
  for (size_t c = 1; c < bins.begin.size(); ++c) {
    bins.begin[c] += bins.begin[c - 1];
  }
  std::vector<size_t> next(bins.begin.begin(), bins.begin.end() - 1);
  bins.ids.resize(n);
  for (size_t i = 0; i < n; ++i) bins.ids[next[cell[i]]++] = ids[i];
  return bins;
}

}  // namespace facet
