// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "texture/tile_painter.h"

#include <algorithm>
#include <cmath>

#include "costs/frame_cell_cost.h"
#include "texture/fill_texture.h"
#include "texture/rgb_sampler.h"
#include "util/parallel_for.h"

namespace facet {
namespace {

using Eigen::Array4f;
using Eigen::Vector3f;

// Which texels of a tile any keyframe sees by the strict tests.
std::vector<uint64_t> SeenWell(const BakeTile& tile,
                               const std::vector<TileSights::View>& views) {
  std::vector<uint64_t> seen(TileSights::NumWords(tile), 0);
  for (const TileSights::View& view : views) {
    for (size_t w = 0; w < seen.size(); ++w) seen[w] |= view.words[w];
  }
  return seen;
}

}  // namespace

// One tile, its sums, and the buffers that its lookups share.
struct TilePainter::TileWork {
  TileWork(const BakeTile& tile_of,
           const BakeTexels& texels,
           const std::vector<Vector3f>& points_of,
           const Chart& chart_of,
           const std::vector<TileSights::View>& views_of)
      : tile(tile_of),
        chart(chart_of),
        views(views_of),
        num_owned(tile.owned_end - tile.begin),
        sums(tile.end - tile.begin),
        points(sums.size()),
        bit(sums.size()),
        is_mild(sums.size()),
        seen(sums.size()),
        lanes(5 * sums.size()),
        colors{lanes.data(),
               lanes.data() + sums.size(),
               lanes.data() + 2 * sums.size(),
               lanes.data() + 3 * sums.size(),
               lanes.data() + 4 * sums.size()} {
    const std::vector<uint64_t> seen_well = SeenWell(tile, views);
    const auto to_mild = static_cast<uint32_t>(64 * seen_well.size());
    for (size_t i = 0; i < sums.size(); ++i) {
      const Vector3f& q = points_of[tile.begin + i];
      points[i] = {q.x(), q.y(), q.z(), 0.0f};
      bit[i] = texels.source[tile.begin + i] - tile.begin;
      is_mild[i] = !(seen_well[bit[i] / 64] >> (bit[i] % 64) & 1);
      if (is_mild[i]) bit[i] += to_mild;
    }
  }

  const BakeTile& tile;
  const Chart& chart;
  const std::vector<TileSights::View>& views;
  const size_t num_owned;
  std::vector<ColorSum> sums;
  std::vector<PhotoTexel> points;
  std::vector<uint32_t> bit;     // of each texel in the words of a view
  std::vector<uint8_t> is_mild;  // no keyframe sees it by the strict tests
  std::vector<uint32_t> seen;    // the texels that the current view shows
  std::vector<float> lanes;
  PhotoColors colors;  // of those
};

TilePainter::TilePainter(const TextureState& state,
                         const Atlas& atlas,
                         const Pinhole& camera,
                         const WarpLattice& lattice,
                         const BakeOptions& options,
                         const BakeTexels& texels,
                         const std::vector<Vector3f>& points,
                         const TileSights& sights)
    : state_(state),
      atlas_(atlas),
      camera_(camera),
      lattice_(lattice),
      warps_(state.warps.begin(), state.warps.end()),
      options_(options),
      texels_(texels),
      points_(points),
      sights_(sights),
      has_powers_(options.angle_power > 0 || options.depth_power > 0 ||
                  options.sharpness_power > 0),
      exposure_share_(state.images.exposures.empty()
                          ? 0.0f
                          : static_cast<float>(options.local_exposure)),
      colors_(texels.size(), Vector3f::Constant(255)),
      seen_(texels.size(), 0),
      reports_(texels.tiles.size()) {
  MakeViews();
}

void TilePainter::MakeViews() {
  const std::vector<float> sharpness =
      Sharpness(state_.images, options_.sharpness_power);
  for (size_t k = 0; k < state_.color_cam_from_world.size(); ++k) {
    const Pose& pose = state_.color_cam_from_world[k];
    View view = {PhotoFrame(),
                 pose.CenterInSource().cast<float>(),
                 &state_.images.rgb[k],
                 ExposureLanes(state_.images.ExposureOf(k)),
                 sharpness[k]};
    SetFrameCamera(camera_, lattice_, &view.frame);
    double block[kPoseSize];
    PoseToBlock(pose, block);
    SetFramePose(block, Eigen::Vector3d::Zero(), &view.frame);
    if (!warps_.empty()) {
      view.frame.warp = warps_.data() + 2ul * lattice_.NumVertices() * k;
    }
    views_.push_back(view);
  }
}

std::vector<cv::Mat> TilePainter::Paint(const std::vector<char>& only_faces,
                                        BakeReport* report) {
  ParallelFor(0, texels_.tiles.size(), [&](size_t t) {
    const BakeTile& tile = texels_.tiles[t];
    reports_[t].texels = tile.owned_end - tile.begin;
    if (IsWanted(tile, only_faces)) PaintTile(t);
  });
  std::vector<cv::Mat> pages = FillPages(
      state_.mesh, atlas_, texels_, seen_, options_.inpaint, &colors_);
  if (report) {
    *report = Total();
    report->unseen_mask = UnseenMask(atlas_, texels_, seen_);
  }
  return pages;
}

bool TilePainter::IsWanted(const BakeTile& tile,
                           const std::vector<char>& only_faces) const {
  if (only_faces.empty()) return true;
  const auto face = texels_.face.begin();
  return std::any_of(face + tile.begin, face + tile.owned_end, [&](int f) {
    return only_faces[f] != 0;
  });
}

BakeReport TilePainter::Total() const {
  BakeReport total;
  for (const BakeReport& part : reports_) {
    total.texels += part.texels;
    total.seen += part.seen;
    total.mild += part.mild;
    total.samples += part.samples;
    total.dropped += part.dropped;
  }
  total.mean_views =
      total.seen ? 1.0 * total.samples / static_cast<double>(total.seen) : 0;
  return total;
}

// cos(theta)^a z^-b s^c
float TilePainter::Powers(const View& view,
                          size_t texel,
                          const Chart& chart) const {
  const Vector3f& q = points_[texel];
  const Vector3f normal =
      TexelNormal(state_.mesh, state_.planes, chart, texels_, texel);
  const float cosine = std::abs(normal.dot((view.center - q).normalized()));
  const PhotoFrame& f = view.frame;
  const float z = f.r[6] * q.x() + f.r[7] * q.y() + f.r[8] * q.z() + f.t[2];
  return std::exp2(
      static_cast<float>(options_.angle_power) *
          std::log2(std::max(cosine, 1e-3f)) -
      static_cast<float>(options_.depth_power) * std::log2(std::max(z, 1e-3f)) +
      static_cast<float>(options_.sharpness_power) * std::log2(view.sharpness));
}

float TilePainter::WeightAt(
    const View& view, const TileWork& work, size_t i, float u, float v) const {
  float weight = 1;
  if (options_.border_feather_px > 0) {
    const float border =
        std::min(std::min(u, static_cast<float>(camera_.width - 1) - u),
                 std::min(v, static_cast<float>(camera_.height - 1) - v));
    weight = std::clamp(
        border / static_cast<float>(options_.border_feather_px), 1e-3f, 1.0f);
  }
  if (has_powers_) weight *= Powers(view, work.tile.begin + i, work.chart);
  if (options_.best_view_power == 1) return weight;
  return std::exp2(static_cast<float>(options_.best_view_power) *
                   std::log2(weight));
}

// Lists the texels that a view shows. Returns how many.
size_t TilePainter::FindSeen(const TileSights::View& sight,
                             TileWork* work) const {
  size_t n = 0;
  for (uint32_t i = 0; i < work->bit.size(); ++i) {
    const uint32_t bit = work->bit[i];
    work->seen[n] = i;
    n += sight.words[bit / 64] >> (bit % 64) & 1;
  }
  return n;
}

// Calls use(i, colour, weight) for the texels of the tile that a view shows.
template <typename Use>
void TilePainter::LookUp(const TileSights::View& sight,
                         TileWork* work,
                         const Use& use) const {
  const View& view = views_[sight.keyframe];
  const size_t n = FindSeen(sight, work);
  const PhotoColors& colors = work->colors;
  GetPhotoKernel().sample_rgb(view.frame,
                              view.rgb->ptr<uint8_t>(),
                              static_cast<ptrdiff_t>(view.rgb->step[0]),
                              work->points.data(),
                              work->seen.data(),
                              n,
                              colors);
  const float right = static_cast<float>(camera_.width - 1);
  const float bottom = static_cast<float>(camera_.height - 1);
  for (size_t j = 0; j < n; ++j) {
    const float u = colors.u[j], v = colors.v[j];
    if (!(u >= 0 && v >= 0 && u <= right && v <= bottom)) continue;
    Array4f taken(colors.red[j], colors.green[j], colors.blue[j], 1);
    if (options_.sampler == BakeSampler::kBicubic) {
      taken.head<3>() = BicubicRgb(*view.rgb, u, v).array();
    }
    const size_t i = work->seen[j];
    use(i,
        Array4f(view.exposure.gain * taken + view.exposure.offset),
        WeightAt(view, *work, i, u, v));
  }
}

void TilePainter::AddTo(const View& view,
                        const Array4f& color,
                        float weight,
                        ColorSum* sum) const {
  sum->Add(color, weight);
  if (exposure_share_ > 0) sum->AddExposure(view.exposure, weight);
}

void TilePainter::Sum(TileWork* work, BakeReport* report) const {
  for (const TileSights::View& sight : work->views) {
    const View& view = views_[sight.keyframe];
    LookUp(sight, work, [&](size_t i, const Array4f& color, float weight) {
      AddTo(view, color, weight, &work->sums[i]);
      report->samples += i < work->num_owned;
    });
  }
}

// Without outliers, for which all samples must be kept.
void TilePainter::SumRobustly(TileWork* work, BakeReport* report) const {
  const size_t n = work->sums.size(), num_views = work->views.size();
  std::vector<ColorSample> samples(n * num_views);
  for (size_t v = 0; v < num_views; ++v) {
    LookUp(work->views[v],
           work,
           [&](size_t i, const Array4f& color, float weight) {
             samples[n * v + i] = {color, weight};
             report->samples += i < work->num_owned;
           });
  }
  report->dropped = DropOutliers(n,
                                 work->num_owned,
                                 num_views,
                                 static_cast<float>(options_.robust_luma),
                                 &samples);
  for (size_t v = 0; v < num_views; ++v) {
    const View& view = views_[work->views[v].keyframe];
    for (size_t i = 0; i < n; ++i) {
      const ColorSample& sample = samples[n * v + i];
      if (!(sample.weight > 0)) continue;
      AddTo(view, sample.color, sample.weight, &work->sums[i]);
    }
  }
}

void TilePainter::PaintTile(size_t t) {
  const BakeTile& tile = texels_.tiles[t];
  TileWork work(
      tile, texels_, points_, atlas_.charts[tile.chart], sights_.ViewsOf(t));
  BakeReport& report = reports_[t];
  if (options_.robust_luma > 0) {
    SumRobustly(&work, &report);
  } else {
    Sum(&work, &report);
  }
  for (size_t i = 0; i < work.sums.size(); ++i) {
    if (!(work.sums[i].weight() > 0)) continue;
    colors_[tile.begin + i] = work.sums[i].Mean(exposure_share_);
    seen_[tile.begin + i] = 1;
    if (i >= work.num_owned) continue;
    ++report.seen;
    report.mild += work.is_mild[i];
  }
}

}  // namespace facet
