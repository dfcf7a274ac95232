// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "problems/texture_problem.h"

#include <glog/logging.h>

#include <algorithm>

#include "costs/frame_cell_cost.h"
#include "costs/plane_manifold.h"
#include "costs/se3_manifold.h"
#include "problems/color_step.h"
#include "util/parallel_for.h"

namespace facet {
namespace {

void BuildTiles(TextureProblem* problem) {
  const std::vector<int>& plane = problem->texels.plane;
  problem->plane_tile_begin.assign(problem->NumPlanes() + 1, 0);
  size_t begin = 0;
  for (int j = 0; j < problem->NumPlanes(); ++j) {
    problem->plane_tile_begin[j] = problem->tiles.size();
    while (begin < plane.size() && plane[begin] == j) {
      size_t end = begin;
      while (end < plane.size() && plane[end] == j &&
             end - begin < kTileTexels) {
        ++end;
      }
      problem->tiles.push_back({j, begin, end, 0, 0});
      begin = end;
    }
  }
  problem->plane_tile_begin.back() = problem->tiles.size();
  CHECK_EQ(begin, plane.size()) << "texels must be sorted by plane";
}

// Cuts each keyframe's ascending texel list at the tile borders.
void BuildSegments(TextureProblem* problem) {
  const Observations& obs = problem->observations;
  const size_t num_tiles = problem->tiles.size();
  std::vector<std::vector<std::pair<uint32_t, TileSegment>>> by_frame(
      problem->NumKeyframes());
  ParallelFor(0, by_frame.size(), [&](size_t k) {
    size_t tile = 0;
    for (size_t i = obs.begin[k]; i < obs.begin[k + 1];) {
      while (problem->tiles[tile].texel_end <= obs.texel[i]) ++tile;
      const uint32_t* first = obs.texel.data() + i;
      const uint32_t* last = obs.texel.data() + obs.begin[k + 1];
      const size_t n = static_cast<size_t>(
          std::lower_bound(first, last,
                           static_cast<uint32_t>(
                               problem->tiles[tile].texel_end)) -
          first);
      by_frame[k].push_back({static_cast<uint32_t>(tile),
                             {static_cast<int>(k), i, i + n}});
      i += n;
    }
  });
  std::vector<size_t> begin(num_tiles + 1, 0);
  for (const auto& list : by_frame) {
    for (const auto& item : list) ++begin[item.first + 1];
  }
  for (size_t t = 0; t < num_tiles; ++t) begin[t + 1] += begin[t];
  problem->segments.resize(begin.back());
  for (size_t t = 0; t < num_tiles; ++t) {
    problem->tiles[t].segment_begin = begin[t];
    problem->tiles[t].segment_end = begin[t + 1];
  }
  for (const auto& list : by_frame) {
    for (const auto& item : list) {
      problem->segments[begin[item.first]++] = item.second;
    }
  }
}

void CountViews(TextureProblem* problem) {
  problem->views.assign(problem->texels.size(), 0);
  for (const uint32_t id : problem->observations.texel) ++problem->views[id];
}

// Moments of the texels that take part, about the planes' anchors.
void BuildMoments(TextureProblem* problem) {
  problem->moments.assign(problem->NumPlanes(), Eigen::Matrix4d::Zero());
  problem->plane_texels.assign(problem->NumPlanes(), 0);
  ParallelFor(0, problem->moments.size(), [&](size_t j) {
    for (size_t t = problem->plane_tile_begin[j];
         t < problem->plane_tile_begin[j + 1]; ++t) {
      const TexelTile& tile = problem->tiles[t];
      for (size_t i = tile.texel_begin; i < tile.texel_end; ++i) {
        if (problem->views[i] == 0) continue;
        Eigen::Vector4d m;
        m << problem->texels.position[i].cast<double>() - problem->anchors[j],
            1.0;
        problem->moments[j].noalias() += m * m.transpose();
        ++problem->plane_texels[j];
      }
    }
  });
}

}  // namespace

Pose ReconState::CamFromWorld(int keyframe) const {
  return PoseFromBlock(poses.data() + kPoseSize * keyframe);
}

Plane ReconState::PlaneAt(int plane, const Eigen::Vector3d& anchor) const {
  const double* block = planes.data() + kPlaneSize * plane;
  Plane result;
  result.normal = Eigen::Vector3d(block[0], block[1], block[2]);
  result.offset = block[3] - result.normal.dot(anchor);
  return result;
}

void FinishTextureProblem(TextureProblem* problem) {
  CHECK_EQ(problem->observations.begin.size(), problem->images.size() + 1);
  if (!problem->texels.position.empty()) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const auto& p : problem->texels.position) sum += p.cast<double>();
    problem->origin = sum / static_cast<double>(problem->texels.size());
  }
  BuildTiles(problem);
  BuildSegments(problem);
  CountViews(problem);
  BuildMoments(problem);
}

ReconState InitialState(const TextureProblem& problem,
                        const std::vector<Plane>& planes) {
  ReconState state;
  state.poses.resize(kPoseSize * problem.NumKeyframes());
  for (int k = 0; k < problem.NumKeyframes(); ++k) {
    PoseToBlock(problem.initial_cam_from_world[k],
                state.poses.data() + kPoseSize * k);
  }
  state.planes.resize(kPlaneSize * problem.NumPlanes());
  for (int j = 0; j < problem.NumPlanes(); ++j) {
    double* block = state.planes.data() + kPlaneSize * j;
    for (int k = 0; k < 3; ++k) block[k] = planes[j].normal[k];
    block[3] = planes[j].SignedDistance(problem.anchors[j]);
  }
  state.warps.assign(2 * static_cast<size_t>(problem.lattice.NumVertices()) *
                         problem.NumKeyframes(),
                     0.0);
  state.colors.assign(problem.texels.size(), 0.0f);
  SolveColors(problem, &state);
  return state;
}

std::vector<PhotoFrame> MakePhotoFrames(const TextureProblem& problem,
                                        const ReconState& state,
                                        bool raw,
                                        std::vector<float>* warps) {
  const size_t num_warp = 2 * static_cast<size_t>(problem.lattice.NumVertices());
  warps->assign(state.warps.begin(), state.warps.end());
  std::vector<PhotoFrame> frames(problem.NumKeyframes());
  for (int k = 0; k < problem.NumKeyframes(); ++k) {
    PhotoFrame& f = frames[k];
    const ImageView<float>& image =
        raw ? problem.raw_images[k] : problem.images[k];
    f.image = image.data;
    f.width = image.width;
    f.height = image.height;
    f.stride = image.stride;
    f.fx = static_cast<float>(problem.camera.fx);
    f.fy = static_cast<float>(problem.camera.fy);
    f.cx = static_cast<float>(problem.camera.cx);
    f.cy = static_cast<float>(problem.camera.cy);
    SetFramePose(state.poses.data() + kPoseSize * k, problem.origin, &f);
    f.columns = problem.lattice.columns;
    f.rows = problem.lattice.rows;
    f.inverse_cell_width = static_cast<float>(1 / problem.lattice.CellWidth());
    f.inverse_cell_height =
        static_cast<float>(1 / problem.lattice.CellHeight());
    const float* begin = warps->data() + num_warp * k;
    if (std::any_of(begin, begin + num_warp, [](float x) { return x != 0; })) {
      f.warp = begin;
    }
  }
  return frames;
}

std::vector<PhotoTexel> PlanePoints(const TextureProblem& problem,
                                    const ReconState& state) {
  std::vector<PhotoTexel> points(problem.texels.size());
  ParallelFor(0, problem.tiles.size(), [&](size_t t) {
    const TexelTile& tile = problem.tiles[t];
    const double* plane = state.planes.data() + kPlaneSize * tile.plane;
    for (size_t i = tile.texel_begin; i < tile.texel_end; ++i) {
      const Eigen::Vector3d q =
          ProjectOntoPlane<double>(plane,
                                   problem.texels.position[i].cast<double>(),
                                   problem.anchors[tile.plane]) -
          problem.origin;
      points[i] = {static_cast<float>(q.x()), static_cast<float>(q.y()),
                   static_cast<float>(q.z()), state.colors[i]};
    }
  });
  return points;
}

std::vector<PhotoTexel> MeshPoints(const TextureProblem& problem,
                                   const ReconState& state) {
  std::vector<PhotoTexel> points(problem.texels.size());
  ParallelForChunks(0, points.size(), kTileTexels, [&](size_t a, size_t b) {
    for (size_t i = a; i < b; ++i) {
      const Eigen::Vector3d p =
          problem.texels.position[i].cast<double>() - problem.origin;
      points[i] = {static_cast<float>(p.x()), static_cast<float>(p.y()),
                   static_cast<float>(p.z()), state.colors[i]};
    }
  });
  return points;
}

}  // namespace facet
