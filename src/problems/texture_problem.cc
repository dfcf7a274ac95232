// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "problems/texture_problem.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "costs/frame_cell_cost.h"
#include "costs/plane_manifold.h"
#include "costs/se3_manifold.h"
#include "geometry/image_sampler.h"
#include "problems/color_step.h"
#include "util/parallel_for.h"

namespace facet {
namespace {

// Cuts the texels, sorted by plane, where `same_tile(a, b)` is false.
template <typename SameTile>
std::vector<TexelTile> CutTiles(const TexelSet& texels,
                                const SameTile& same_tile) {
  std::vector<TexelTile> tiles;
  for (size_t begin = 0; begin < texels.size();) {
    size_t end = begin + 1;
    while (end < texels.size() && texels.plane[end] == texels.plane[begin] &&
           end - begin < kTileTexels && same_tile(begin, end)) {
      ++end;
    }
    tiles.push_back({texels.plane[begin], begin, end, 0, 0});
    begin = end;
  }
  return tiles;
}

void IndexTiles(TextureProblem* problem) {
  problem->plane_tile_begin.assign(problem->NumPlanes() + 1, 0);
  int previous = 0;
  for (const TexelTile& tile : problem->tiles) {
    CHECK_LE(previous, tile.plane) << "texels must be sorted by plane";
    previous = tile.plane;
    ++problem->plane_tile_begin[tile.plane + 1];
  }
  for (int j = 0; j < problem->NumPlanes(); ++j) {
    problem->plane_tile_begin[j + 1] += problem->plane_tile_begin[j];
  }
}

template <typename T>
void Permute(const std::vector<uint32_t>& order, std::vector<T>* values) {
  std::vector<T> sorted(values->size());
  for (size_t i = 0; i < order.size(); ++i) sorted[i] = (*values)[order[i]];
  values->swap(sorted);
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
          std::lower_bound(
              first,
              last,
              static_cast<uint32_t>(problem->tiles[tile].texel_end)) -
          first);
      by_frame[k].push_back(
          {static_cast<uint32_t>(tile), {static_cast<int>(k), i, i + n}});
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
  problem->keyframe_segments.clear();
  problem->keyframe_segment_begin.assign(1, 0);
  for (const auto& list : by_frame) {
    for (const auto& item : list) {
      const size_t s = begin[item.first]++;
      problem->segments[s] = item.second;
      problem->keyframe_segments.push_back(static_cast<uint32_t>(s));
    }
    problem->keyframe_segment_begin.push_back(
        problem->keyframe_segments.size());
  }
}

void CountViews(TextureProblem* problem) {
  problem->views.assign(problem->texels.size(), 0);
  for (const uint32_t id : problem->observations.texel) ++problem->views[id];
}

void AddToMoment(const Eigen::Vector3f& position,
                 const Eigen::Vector3d& anchor,
                 Eigen::Matrix4d* moment) {
  Eigen::Vector4d m;
  m << position.cast<double>() - anchor, 1.0;
  moment->noalias() += m * m.transpose();
}

// sum m m' over the surface, m = (x - anchor, 1), times the density.
Eigen::Matrix4d SurfaceMoment(const SurfaceMoments& surface,
                              const Eigen::Vector3d& anchor,
                              double density) {
  Eigen::Vector4d m;
  m << surface.centroid - anchor, 1.0;
  Eigen::Matrix4d moment = surface.area * m * m.transpose();
  moment.topLeftCorner<3, 3>() += surface.Covariance();
  return density * moment;
}

// Moments of the surface or the texels of observed planes, about the planes'
// anchors.
void BuildMoments(TextureProblem* problem) {
  const TexelSet& texels = problem->texels;
  problem->moments.assign(problem->NumPlanes(), Eigen::Matrix4d::Zero());
  problem->plane_texels.assign(problem->NumPlanes(), 0);
  ParallelFor(0, problem->moments.size(), [&](size_t j) {
    for (size_t t = problem->plane_tile_begin[j];
         t < problem->plane_tile_begin[j + 1];
         ++t) {
      const TexelTile& tile = problem->tiles[t];
      for (size_t i = tile.texel_begin; i < tile.texel_end; ++i) {
        AddToMoment(
            texels.position[i], problem->anchors[j], &problem->moments[j]);
        problem->plane_texels[j] += problem->views[i] > 0 ? 1 : 0;
      }
    }
  });
  for (size_t i = 0; i < texels.margin_position.size(); ++i) {
    const int j = texels.margin_plane[i];
    AddToMoment(
        texels.margin_position[i], problem->anchors[j], &problem->moments[j]);
  }
  for (int j = 0; j < problem->NumPlanes(); ++j) {
    if (problem->plane_texels[j] == 0) {
      problem->moments[j].setZero();
    } else if (!problem->surface.empty()) {
      problem->moments[j] = SurfaceMoment(
          problem->surface[j], problem->anchors[j], problem->texels_per_m2);
    }
  }
}

void BuildGradients(TextureProblem* problem) {
  problem->gradients_x.clear();
  problem->gradients_y.clear();
  if (problem->formulation.sampling != Sampling::kScharr) return;
  const int num_keyframes = problem->NumKeyframes();
  const size_t num_images =
      static_cast<size_t>(problem->NumChannels()) * num_keyframes;
  problem->gradients_x.resize(num_images);
  problem->gradients_y.resize(num_images);
  ParallelFor(0, num_images, [&](size_t i) {
    ScharrGradients(problem->Image(static_cast<int>(i) / num_keyframes,
                                   static_cast<int>(i) % num_keyframes),
                    &problem->gradients_x[i],
                    &problem->gradients_y[i]);
    problem->ReleaseImages(static_cast<int>(i) % num_keyframes);
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

std::vector<TexelTile> SortTexelsIntoTiles(
    const std::vector<Plane>& planes,
    const std::vector<Eigen::Vector3d>& anchors,
    int size,
    TexelSet* texels) {
  const double tile_m = size * texels->stride * texels->spacing_m;
  std::vector<std::array<int, 2>> cell(texels->size());
  ParallelForChunks(0, cell.size(), kTileTexels, [&](size_t a, size_t b) {
    for (size_t i = a; i < b; ++i) {
      const int j = texels->plane[i];
      const Eigen::Vector3d e1 = planes[j].normal.unitOrthogonal();
      const Eigen::Vector3d e2 = planes[j].normal.cross(e1);
      const Eigen::Vector3d p = texels->position[i].cast<double>() - anchors[j];
      cell[i] = {static_cast<int>(std::floor(e1.dot(p) / tile_m)),
                 static_cast<int>(std::floor(e2.dot(p) / tile_m))};
    }
  });
  std::vector<uint32_t> order(texels->size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) {
    return std::make_tuple(texels->plane[a], cell[a], a) <
           std::make_tuple(texels->plane[b], cell[b], b);
  });
  Permute(order, &texels->position);
  Permute(order, &texels->plane);
  Permute(order, &texels->face);
  Permute(order, &texels->bary);
  Permute(order, &cell);
  return CutTiles(*texels,
                  [&](size_t a, size_t b) { return cell[a] == cell[b]; });
}

void FinishTextureProblem(TextureProblem* problem) {
  CHECK_EQ(problem->observations.begin.size(), problem->images.size() + 1);
  if (!problem->texels.position.empty()) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const auto& p : problem->texels.position) sum += p.cast<double>();
    problem->origin = sum / static_cast<double>(problem->texels.size());
  }
  if (problem->tiles.empty()) {
    problem->tiles =
        CutTiles(problem->texels, [](size_t, size_t) { return true; });
  }
  IndexTiles(problem);
  BuildSegments(problem);
  CountViews(problem);
  BuildMoments(problem);
  BuildGradients(problem);
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
  state.colors.assign(problem.NumChannels() * problem.texels.size(), 0.0f);
  SolveColors(problem, &state);
  return state;
}

std::vector<PhotoFrame> MakePhotoFrames(const TextureProblem& problem,
                                        const ReconState& state,
                                        bool raw,
                                        std::vector<float>* warps,
                                        int channel) {
  const Formulation& formulation = problem.formulation;
  const size_t num_warp =
      2 * static_cast<size_t>(problem.lattice.NumVertices());
  warps->assign(state.warps.begin(), state.warps.end());
  std::vector<PhotoFrame> frames(problem.NumKeyframes());
  for (int k = 0; k < problem.NumKeyframes(); ++k) {
    PhotoFrame& f = frames[k];
    const ImageView<float>& image =
        raw ? problem.raw_images[k] : problem.Image(channel, k);
    SetFrameCamera(problem.camera, problem.lattice, &f);
    f.image = image.data;
    f.width = image.width;
    f.height = image.height;
    f.stride = image.stride;
    SetFramePose(state.poses.data() + kPoseSize * k, problem.origin, &f);
    const float* begin = warps->data() + num_warp * k;
    if (std::any_of(begin, begin + num_warp, [](float x) { return x != 0; })) {
      f.warp = begin;
    }
    if (raw) continue;
    f.sampling = formulation.sampling;
    f.loss = formulation.loss;
    f.loss_scale = static_cast<float>(formulation.loss_scale);
    f.out_of_image = formulation.out_of_image;
    if (f.sampling == Sampling::kScharr) {
      const size_t i = static_cast<size_t>(channel) * frames.size() + k;
      f.gradient_x = problem.gradients_x[i].data();
      f.gradient_y = problem.gradients_y[i].data();
    }
  }
  return frames;
}

std::vector<PhotoTexel> PlanePoints(const TextureProblem& problem,
                                    const ReconState& state,
                                    int channel) {
  std::vector<PhotoTexel> points(problem.texels.size());
  const float* colors = state.colors.data() + channel * points.size();
  ParallelFor(0, problem.tiles.size(), [&](size_t t) {
    const TexelTile& tile = problem.tiles[t];
    const double* plane = state.planes.data() + kPlaneSize * tile.plane;
    for (size_t i = tile.texel_begin; i < tile.texel_end; ++i) {
      const Eigen::Vector3d q =
          ProjectOntoPlane<double>(plane,
                                   problem.texels.position[i].cast<double>(),
                                   problem.anchors[tile.plane]) -
          problem.origin;
      points[i] = {static_cast<float>(q.x()),
                   static_cast<float>(q.y()),
                   static_cast<float>(q.z()),
                   colors[i]};
    }
  });
  return points;
}

std::vector<PhotoTexel> MeshPoints(const TextureProblem& problem,
                                   const ReconState& state,
                                   int channel) {
  std::vector<PhotoTexel> points(problem.texels.size());
  const float* colors = state.colors.data() + channel * points.size();
  ParallelForChunks(0, points.size(), kTileTexels, [&](size_t a, size_t b) {
    for (size_t i = a; i < b; ++i) {
      const Eigen::Vector3d p =
          problem.texels.position[i].cast<double>() - problem.origin;
      points[i] = {static_cast<float>(p.x()),
                   static_cast<float>(p.y()),
                   static_cast<float>(p.z()),
                   colors[i]};
    }
  });
  return points;
}

PhotoChannel MakePhotoChannel(const TextureProblem& problem,
                              const ReconState& state,
                              PointsAt points,
                              bool raw,
                              int channel) {
  PhotoChannel result;
  result.frames = MakePhotoFrames(problem, state, raw, &result.warps, channel);
  result.points = points == PointsAt::kPlane
                      ? PlanePoints(problem, state, channel)
                      : MeshPoints(problem, state, channel);
  return result;
}

std::vector<PhotoChannel> MakePhotoChannels(const TextureProblem& problem,
                                            const ReconState& state,
                                            PointsAt points) {
  std::vector<PhotoChannel> channels;
  for (int c = 0; c < problem.NumChannels(); ++c) {
    channels.push_back(MakePhotoChannel(problem, state, points, false, c));
  }
  return channels;
}

SampledImage SampledImageOf(const TextureProblem& problem,
                            int channel,
                            int keyframe) {
  SampledImage image(problem.Image(channel, keyframe));
  image.sampling = problem.formulation.sampling;
  image.gradient_x = image.gradient_y = image.image;
  if (image.sampling == Sampling::kScharr) {
    const size_t i =
        static_cast<size_t>(channel) * problem.NumKeyframes() + keyframe;
    image.gradient_x.data = problem.gradients_x[i].data();
    image.gradient_y.data = problem.gradients_y[i].data();
  }
  return image;
}

}  // namespace facet
