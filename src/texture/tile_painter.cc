// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "texture/tile_painter.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "costs/frame_cell_cost.h"
#include "texture/fill_texture.h"
#include "texture/rgb_sampler.h"
#include "util/parallel_for.h"

namespace facet {
namespace {

using Eigen::Vector3f;

constexpr size_t kBlock = ColorSums::kBlock;

// Neighbours read the same parts of the same images: their memory is given back
// after so many tiles.
constexpr size_t kTilesPerRelease = 8;

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

// One tile, its sums, and the samples of the current view. Texels are handled
// in blocks: those of which a view shows any are looked up as a whole, and what
// it does not show has the weight 0.
struct TilePainter::TileWork {
  TileWork(const BakeTile& tile_of,
           const BakeTexels& texels,
           const std::vector<Vector3f>& points_of,
           const Chart& chart_of,
           const std::vector<TileSights::View>& views_of)
      : tile(tile_of),
        chart(chart_of),
        views(views_of),
        num_texels(tile.end - tile.begin),
        num_owned(tile.owned_end - tile.begin),
        num_blocks((num_texels + kBlock - 1) / kBlock),
        sums(num_blocks),
        points(kBlock * num_blocks),
        source(num_texels),
        bit(num_texels),
        is_mild(num_texels),
        power(num_texels, 0.0f),
        lanes(6 * kBlock * num_blocks),
        colors{Lane(0), Lane(1), Lane(2), Lane(3), Lane(4)},
        weight(Lane(5)) {
    const std::vector<uint64_t> seen_well = SeenWell(tile, views);
    const auto to_mild = static_cast<uint32_t>(64 * seen_well.size());
    for (size_t i = 0; i < num_texels; ++i) {
      source[i] = texels.source[tile.begin + i] - tile.begin;
      bit[i] = source[i];
      is_mild[i] = !(seen_well[bit[i] / 64] >> (bit[i] % 64) & 1);
      if (is_mild[i]) bit[i] += to_mild;
    }
    for (size_t i = 0; i < points.size(); ++i) {
      const size_t texel = std::min(i, num_texels - 1);
      const Vector3f& q = points_of[tile.begin + texel];
      points[i] = {q.x(), q.y(), q.z(), 0.0f};
    }
    ids.reserve(points.size());
    blocks.reserve(num_blocks);
  }

  float* Lane(size_t k) { return lanes.data() + k * kBlock * num_blocks; }

  // How many of the current samples are of texels in faces.
  size_t CountOwned() const {
    size_t count = 0;
    for (size_t j = 0; j < ids.size(); ++j) {
      count += ids[j] < num_owned && weight[j] > 0;
    }
    return count;
  }

  const BakeTile& tile;
  const Chart& chart;
  const std::vector<TileSights::View>& views;
  const size_t num_texels, num_owned, num_blocks;
  ColorSums sums;
  std::vector<PhotoTexel> points;  // of whole blocks
  std::vector<uint32_t> source;    // of each texel, among them
  std::vector<uint32_t> bit;       // of each texel in the words of a view
  std::vector<uint8_t> is_mild;    // no keyframe sees it by the strict tests

  // Of the current view: the blocks, their texels, the samples of these.
  std::vector<uint32_t> blocks, ids;
  std::vector<float> power;  // of sources
  std::vector<float> lanes;
  PhotoColors colors;
  float* weight;
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
                 ByteExposure(state_.images.ExposureOf(k)),
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
  std::atomic<size_t> painted = 0;
  ParallelFor(0, texels_.tiles.size(), [&](size_t t) {
    const BakeTile& tile = texels_.tiles[t];
    reports_[t].texels = tile.owned_end - tile.begin;
    if (!IsWanted(tile, only_faces)) return;
    PaintTile(t);
    if (++painted % kTilesPerRelease == 0) ReleaseImages();
  });
  ReleaseImages();
  std::vector<cv::Mat> pages = FillPages(
      state_.mesh, atlas_, texels_, seen_, options_.inpaint, &colors_);
  if (report) {
    *report = Total();
    report->unseen_mask = UnseenMask(atlas_, texels_, seen_);
  }
  return pages;
}

void TilePainter::ReleaseImages() const {
  for (const cv::Mat& rgb : state_.images.rgb) ReleasePages(rgb);
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

// Lists the blocks with a texel that the view shows; weights are 1 where it
// does and 0 elsewhere.
void TilePainter::FindShown(const TileSights::View& sight,
                            TileWork* work) const {
  work->blocks.clear();
  work->ids.clear();
  for (size_t block = 0; block < work->num_blocks; ++block) {
    const size_t begin = kBlock * block;
    const size_t end = std::min(begin + kBlock, work->num_texels);
    float* shown = work->weight + work->ids.size();
    float any = 0;
    std::fill(shown, shown + kBlock, 0.0f);
    for (size_t i = begin; i < end; ++i) {
      const uint32_t bit = work->bit[i];
      shown[i - begin] =
          static_cast<float>(sight.words[bit / 64] >> (bit % 64) & 1);
      any += shown[i - begin];
    }
    if (any == 0) continue;
    work->blocks.push_back(static_cast<uint32_t>(block));
    for (size_t i = 0; i < kBlock; ++i) {
      work->ids.push_back(static_cast<uint32_t>(begin + i));
    }
  }
}

// Samples of the tile in one view, at the common exposure.
void TilePainter::LookUp(const TileSights::View& sight, TileWork* work) const {
  const View& view = views_[sight.keyframe];
  FindShown(sight, work);
  GetPhotoKernel().sample_rgb(view.frame,
                              view.rgb->ptr<uint8_t>(),
                              static_cast<ptrdiff_t>(view.rgb->step[0]),
                              work->points.data(),
                              work->ids.data(),
                              work->ids.size(),
                              work->colors);
  Weigh(view, work);
  if (options_.sampler == BakeSampler::kBicubic) LookUpSmoothly(view, work);
  ToCommonExposure(view, work);
}

// Multiplies by what a sample at (u, v) counts: nothing outside of the image.
void TilePainter::Weigh(const View& view, TileWork* work) const {
  const size_t n = work->ids.size();
  const float right = static_cast<float>(camera_.width - 1);
  const float bottom = static_cast<float>(camera_.height - 1);
  const bool has_ramp = options_.border_feather_px > 0;
  const float per_px =
      has_ramp ? 1 / static_cast<float>(options_.border_feather_px) : 0.0f;
  const float least = has_ramp ? 1e-3f : 1.0f;
  const float *u = work->colors.u, *v = work->colors.v;
  float* weight = work->weight;
  for (size_t j = 0; j < n; ++j) {
    const float border =
        std::min(std::min(u[j], right - u[j]), std::min(v[j], bottom - v[j]));
    const float ramp = std::min(std::max(border * per_px, least), 1.0f);
    weight[j] *= border >= 0 ? ramp : 0.0f;
  }
  if (has_powers_) WeighByView(view, work);
  if (options_.best_view_power == 1) return;
  const float power = static_cast<float>(options_.best_view_power);
  for (size_t j = 0; j < n; ++j) {
    if (weight[j] > 0) weight[j] = std::exp2(power * std::log2(weight[j]));
  }
}

// Multiplies by the powers, which texels have from where their visibility was
// tested: a shown texel's source is shown as well, so in the list, and it comes
// first.
void TilePainter::WeighByView(const View& view, TileWork* work) const {
  for (size_t j = 0; j < work->ids.size(); ++j) {
    const uint32_t id = work->ids[j];
    if (id >= work->num_texels) continue;  // of the last block
    if (work->source[id] == id) {
      work->power[id] = Powers(view, work->tile.begin + id, work->chart);
    }
    work->weight[j] *= work->power[work->source[id]];
  }
}

// The colours again, by the bicubic sampler.
void TilePainter::LookUpSmoothly(const View& view, TileWork* work) const {
  const PhotoColors& c = work->colors;
  for (size_t j = 0; j < work->ids.size(); ++j) {
    if (!(work->weight[j] > 0)) continue;
    const Vector3f rgb = BicubicRgb(*view.rgb, c.u[j], c.v[j]);
    c.red[j] = rgb.x();
    c.green[j] = rgb.y();
    c.blue[j] = rgb.z();
  }
}

void TilePainter::ToCommonExposure(const View& view, TileWork* work) const {
  const PhotoColors& c = work->colors;
  float* const rows[3] = {c.red, c.green, c.blue};
  const size_t n = work->ids.size();
  for (int k = 0; k < 3; ++k) {
    const float gain = view.exposure.gain[k], offset = view.exposure.offset[k];
    float* row = rows[k];
    for (size_t j = 0; j < n; ++j) row[j] = gain * row[j] + offset;
  }
}

// The current samples to the sums.
void TilePainter::Add(const View& view, TileWork* work) const {
  const PhotoColors& c = work->colors;
  const ByteExposure* exposure = exposure_share_ > 0 ? &view.exposure : nullptr;
  for (size_t b = 0; b < work->blocks.size(); ++b) {
    const size_t at = kBlock * b;
    const float* const rgb[3] = {c.red + at, c.green + at, c.blue + at};
    work->sums.Add(work->blocks[b], rgb, work->weight + at, exposure);
  }
}

void TilePainter::Sum(TileWork* work, BakeReport* report) const {
  for (const TileSights::View& sight : work->views) {
    LookUp(sight, work);
    report->samples += work->CountOwned();
    Add(views_[sight.keyframe], work);
  }
}

// Without outliers, for which all samples must be kept.
void TilePainter::SumRobustly(TileWork* work, BakeReport* report) const {
  const size_t n = work->points.size(), num_views = work->views.size();
  const PhotoColors& c = work->colors;
  std::vector<ColorSample> samples(n * num_views);
  for (size_t v = 0; v < num_views; ++v) {
    LookUp(work->views[v], work);
    report->samples += work->CountOwned();
    for (size_t j = 0; j < work->ids.size(); ++j) {
      samples[n * v + work->ids[j]] = {{c.red[j], c.green[j], c.blue[j]},
                                       work->weight[j]};
    }
  }
  report->dropped = DropOutliers(n,
                                 work->num_owned,
                                 num_views,
                                 static_cast<float>(options_.robust_luma),
                                 &samples);
  for (size_t v = 0; v < num_views; ++v) {
    const TileSights::View& sight = work->views[v];
    FindShown(sight, work);
    for (size_t j = 0; j < work->ids.size(); ++j) {
      const ColorSample& sample = samples[n * v + work->ids[j]];
      c.red[j] = sample.rgb[0];
      c.green[j] = sample.rgb[1];
      c.blue[j] = sample.rgb[2];
      work->weight[j] = sample.weight;
    }
    Add(views_[sight.keyframe], work);
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
  for (size_t i = 0; i < work.num_texels; ++i) {
    if (!(work.sums.Weight(i) > 0)) continue;
    colors_[tile.begin + i] = work.sums.Mean(i, exposure_share_);
    seen_[tile.begin + i] = 1;
    if (i >= work.num_owned) continue;
    ++report.seen;
    report.mild += work.is_mild[i];
  }
}

}  // namespace facet
