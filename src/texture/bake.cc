// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "texture/bake.h"

#include <algorithm>
#include <cmath>

#include "texture/bake_colors.h"
#include "texture/bake_texels.h"
#include "texture/fill_texture.h"
#include "texture/rgb_sampler.h"
#include "texture/visibility.h"
#include "util/errors.h"
#include "util/parallel_for.h"

namespace facet {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

// For each tile that a keyframe sees at all: a bit a texel by Test(), then a
// bit a texel by its milder verdict.
struct FrameBits {
  std::vector<uint32_t> tile;
  std::vector<uint32_t> first_word;
  std::vector<uint64_t> words;
};

struct TileView {
  int keyframe = 0;
  const uint64_t* words = nullptr;
};

class Baker {
 public:
  Baker(const TriMesh& mesh,
        const std::vector<Plane>& planes,
        const Atlas& atlas,
        const RayScene& scene,
        const RgbdSequence& sequence,
        const std::vector<int>& keyframes,
        const KeyframeImages& images,
        const std::vector<Pose>& color_cam_from_world,
        const WarpLattice& lattice,
        const std::vector<double>& warps,
        const VisibilityOptions& visibility,
        const BakeOptions& options,
        const std::vector<char>& only_faces)
      : mesh_(mesh),
        planes_(planes),
        atlas_(atlas),
        scene_(scene),
        sequence_(sequence),
        keyframes_(keyframes),
        images_(images),
        poses_(color_cam_from_world),
        lattice_(lattice),
        warps_(warps.begin(), warps.end()),
        visibility_(visibility),
        options_(options),
        camera_(sequence.calibration().color),
        has_powers_(options.angle_power > 0 || options.depth_power > 0 ||
                    options.sharpness_power > 0),
        texels_(MakeBakeTexels(mesh, planes, atlas, options.ring_px)),
        only_faces_(only_faces) {}

  std::vector<cv::Mat> Run(BakeReport* report) {
    FindVisibility();
    sharpness_ = Sharpness(images_, options_.sharpness_power);
    colors_.resize(texels_.size(), Vector3f::Constant(255));
    seen_.assign(texels_.size(), 0);
    tile_reports_.resize(texels_.tiles.size());
    ParallelFor(0, texels_.tiles.size(), [this](size_t t) { ColorTile(t); });
    BakeReport total;
    for (const BakeReport& part : tile_reports_) {
      total.texels += part.texels;
      total.seen += part.seen;
      total.mild += part.mild;
      total.samples += part.samples;
      total.dropped += part.dropped;
    }
    total.mean_views =
        total.seen ? 1.0 * total.samples / static_cast<double>(total.seen) : 0;
    std::vector<cv::Mat> pages =
        FillPages(mesh_, atlas_, texels_, seen_, options_.inpaint, &colors_);
    if (report) {
      total.unseen_mask = UnseenMask(atlas_, texels_, seen_);
      *report = std::move(total);
    }
    return pages;
  }

 private:
  Vector3f Normal(const Chart& chart, size_t texel) const {
    if (chart.steep) {
      return mesh_.FaceCross(texels_.face[texel]).normalized().cast<float>();
    }
    const Vector3f n = planes_[chart.plane].normal.cast<float>();
    return chart.back ? Vector3f(-n) : n;
  }

  void FindVisibility() {
    const auto& tiles = texels_.tiles;
    std::vector<Ball> balls(tiles.size());
    wanted_.assign(tiles.size(), 1);
    ParallelFor(0, tiles.size(), [&](size_t t) {
      wanted_[t] = IsWanted(tiles[t]);
      balls[t] = BallAround(texels_.q.data() + tiles[t].begin,
                            tiles[t].owned_end - tiles[t].begin);
    });
    frames_.resize(keyframes_.size());
    ParallelFor(0, keyframes_.size(), [&](size_t k) { LookFrom(k, balls); });
    tile_views_.resize(tiles.size());
    for (size_t k = 0; k < frames_.size(); ++k) {
      const FrameBits& bits = frames_[k];
      for (size_t i = 0; i < bits.tile.size(); ++i) {
        tile_views_[bits.tile[i]].push_back(
            {static_cast<int>(k), bits.words.data() + bits.first_word[i]});
      }
    }
  }

  bool IsWanted(const BakeTile& tile) const {
    if (only_faces_.empty()) return true;
    const auto face = texels_.face.begin();
    return std::any_of(face + tile.begin, face + tile.owned_end, [&](int f) {
      return only_faces_[f] != 0;
    });
  }

  static size_t NumWords(const BakeTile& tile) {
    return (tile.owned_end - tile.begin + 63) / 64;
  }

  void LookFrom(size_t k, const std::vector<Ball>& balls) {
    const bool needs_depth =
        visibility_.test_sensor_depth || visibility_.test_depth_edges;
    const FrameView view(
        sequence_.calibration(),
        poses_[k],
        needs_depth ? sequence_.LoadDepth(keyframes_[k]) : cv::Mat(),
        scene_,
        visibility_);
    FrameBits& bits = frames_[k];
    std::vector<uint64_t> words;
    for (size_t t = 0; t < texels_.tiles.size(); ++t) {
      if (!wanted_[t] || view.TestBall(balls[t]) != Sight::kVisible) continue;
      const BakeTile& tile = texels_.tiles[t];
      const Chart& chart = atlas_.charts[tile.chart];
      Vector3f normal = Normal(chart, tile.begin);
      if (visibility_.test_angle && !chart.steep &&
          normal.dot(view.center() - balls[t].center) < -balls[t].radius) {
        continue;
      }
      const size_t num_words = NumWords(tile);
      words.assign(2 * num_words, 0);
      bool any = false;
      for (uint32_t i = tile.begin; i < tile.owned_end; ++i) {
        if (chart.steep) normal = Normal(chart, i);
        const Vector3f &p = texels_.p[i], &q = texels_.q[i];
        size_t word = (i - tile.begin) / 64;
        bool may_see = false;
        if (view.Test(
                p, q, normal, options_.mild_fallback ? &may_see : nullptr) !=
            Sight::kVisible) {
          if (!may_see) continue;
          word += num_words;
        }
        words[word] |= uint64_t{1} << ((i - tile.begin) % 64);
        any = true;
      }
      if (!any) continue;
      bits.tile.push_back(static_cast<uint32_t>(t));
      bits.first_word.push_back(static_cast<uint32_t>(bits.words.size()));
      bits.words.insert(bits.words.end(), words.begin(), words.end());
    }
  }

  // w before the power e is the product of these two.
  float Powers(float cosine, float z, float sharpness) const {
    return std::exp2(static_cast<float>(options_.angle_power) *
                         std::log2(std::max(cosine, 1e-3f)) -
                     static_cast<float>(options_.depth_power) * std::log2(z) +
                     static_cast<float>(options_.sharpness_power) *
                         std::log2(sharpness));
  }

  float RampAt(const Vector2f& u) const {
    if (!(options_.border_feather_px > 0)) return 1;
    const float border =
        std::min({u.x(),
                  u.y(),
                  static_cast<float>(camera_.width - 1) - u.x(),
                  static_cast<float>(camera_.height - 1) - u.y()});
    return std::clamp(
        border / static_cast<float>(options_.border_feather_px), 1e-3f, 1.0f);
  }

  // All texels of a tile in one keyframe.
  void SampleView(const BakeTile& tile,
                  const TileView& view,
                  const std::vector<uint64_t>& seen_well,
                  ColorSample* samples) const {
    const Pose& pose = poses_[view.keyframe];
    const Eigen::Matrix3f rotation = pose.RotationMatrix().cast<float>();
    const Vector3f translation = pose.translation.cast<float>();
    const Vector3f center = pose.CenterInSource().cast<float>();
    const cv::Mat& rgb = images_.rgb[view.keyframe];
    const Exposure exposure = images_.ExposureOf(view.keyframe);
    const float* warp =
        warps_.empty()
            ? nullptr
            : warps_.data() + 2ul * lattice_.NumVertices() * view.keyframe;
    const float fx = static_cast<float>(camera_.fx);
    const float fy = static_cast<float>(camera_.fy);
    const float cx = static_cast<float>(camera_.cx);
    const float cy = static_cast<float>(camera_.cy);
    const float right = static_cast<float>(camera_.width - 1);
    const float bottom = static_cast<float>(camera_.height - 1);
    const Chart& chart = atlas_.charts[tile.chart];
    Vector3f normal = Normal(chart, tile.begin);
    for (uint32_t i = tile.begin; i < tile.end; ++i) {
      ColorSample& sample = samples[i - tile.begin];
      sample = ColorSample();
      const uint32_t bit = texels_.source[i] - tile.begin;
      const bool well = seen_well[bit / 64] >> (bit % 64) & 1;
      const size_t word = bit / 64 + (well ? 0 : seen_well.size());
      if (!(view.words[word] >> (bit % 64) & 1)) continue;
      const Vector3f y = rotation * texels_.q[i] + translation;
      if (!(y.z() > 0.01f)) continue;
      Vector2f u(fx * y.x() / y.z() + cx, fy * y.y() / y.z() + cy);
      if (warp) u = lattice_.Apply(warp, u);
      if (!(u.x() >= 0 && u.y() >= 0 && u.x() <= right && u.y() <= bottom)) {
        continue;
      }
      sample.rgb = exposure.Corrected(options_.sampler == BakeSampler::kBilinear
                                          ? BilinearRgb(rgb, u.x(), u.y())
                                          : BicubicRgb(rgb, u.x(), u.y()));
      sample.weight = RampAt(u);
      if (!has_powers_) continue;
      if (chart.steep) normal = Normal(chart, i);
      const float cosine = normal.dot((center - texels_.q[i]).normalized());
      sample.weight *=
          Powers(std::abs(cosine), y.z(), sharpness_[view.keyframe]);
    }
  }

  void ColorTile(size_t t) {
    const BakeTile& tile = texels_.tiles[t];
    BakeReport& report = tile_reports_[t];
    const size_t n = tile.end - tile.begin, owned = tile.owned_end - tile.begin;
    report.texels = owned;
    const std::vector<TileView>& views = tile_views_[t];
    // Texels that any keyframe sees by the strict tests.
    std::vector<uint64_t> seen_well(NumWords(tile), 0);
    for (const TileView& view : views) {
      for (size_t w = 0; w < seen_well.size(); ++w)
        seen_well[w] |= view.words[w];
    }
    std::vector<ColorSample> samples(n * views.size());
    for (size_t v = 0; v < views.size(); ++v) {
      SampleView(tile, views[v], seen_well, samples.data() + n * v);
      for (size_t i = 0; i < owned; ++i) {
        report.samples += samples[n * v + i].weight > 0;
      }
    }
    if (options_.robust_luma > 0) {
      report.dropped = DropOutliers(n,
                                    owned,
                                    views.size(),
                                    static_cast<float>(options_.robust_luma),
                                    &samples);
    }
    std::vector<ColorSample> mean = WeightedMean(
        samples, n, views.size(), static_cast<float>(options_.best_view_power));
    if (options_.local_exposure > 0 && !images_.exposures.empty()) {
      std::vector<Exposure> exposures;
      for (const TileView& view : views) {
        exposures.push_back(images_.ExposureOf(view.keyframe));
      }
      UndoExposures(samples,
                    exposures,
                    static_cast<float>(options_.local_exposure),
                    &mean);
    }
    for (size_t i = 0; i < n; ++i) {
      if (!(mean[i].weight > 0)) continue;
      colors_[tile.begin + i] = mean[i].rgb;
      seen_[tile.begin + i] = 1;
      if (i >= owned) continue;
      ++report.seen;
      report.mild += !(seen_well[i / 64] >> (i % 64) & 1);
    }
  }

  const TriMesh& mesh_;
  const std::vector<Plane>& planes_;
  const Atlas& atlas_;
  const RayScene& scene_;
  const RgbdSequence& sequence_;
  const std::vector<int>& keyframes_;
  const KeyframeImages& images_;
  const std::vector<Pose>& poses_;
  const WarpLattice& lattice_;
  const std::vector<float> warps_;
  const VisibilityOptions& visibility_;
  const BakeOptions& options_;
  const Pinhole camera_;
  const bool has_powers_;  // weights differ by more than the ramp
  const BakeTexels texels_;
  const std::vector<char>& only_faces_;
  std::vector<char> wanted_;                       // by tile
  std::vector<FrameBits> frames_;                  // by keyframe
  std::vector<std::vector<TileView>> tile_views_;  // ascending keyframe
  std::vector<float> sharpness_;
  std::vector<Vector3f> colors_;  // by texel
  std::vector<uint8_t> seen_;
  std::vector<BakeReport> tile_reports_;
};

}  // namespace

std::vector<cv::Mat> BakeTexture(const TriMesh& mesh,
                                 const std::vector<Plane>& planes,
                                 const Atlas& atlas,
                                 const RayScene& scene,
                                 const RgbdSequence& sequence,
                                 const std::vector<int>& keyframes,
                                 const KeyframeImages& images,
                                 const std::vector<Pose>& color_cam_from_world,
                                 const WarpLattice& lattice,
                                 const std::vector<double>& warps,
                                 const VisibilityOptions& visibility,
                                 const BakeOptions& options,
                                 BakeReport* report,
                                 const std::vector<char>& only_faces) {
  if (options.angle_power < 0 || options.depth_power < 0 ||
      options.sharpness_power < 0 || !(options.best_view_power > 0) ||
      options.ring_px < 0) {
    throw OptionsError(
        "powers of the texture weights must not be negative, and the best-view "
        "power must be positive");
  }
  if (!(options.local_exposure >= 0 && options.local_exposure <= 1)) {
    throw OptionsError("the share of the local exposure must be in 0 to 1");
  }
  return Baker(mesh,
               planes,
               atlas,
               scene,
               sequence,
               keyframes,
               images,
               color_cam_from_world,
               lattice,
               warps,
               visibility,
               options,
               only_faces)
      .Run(report);
}

}  // namespace facet
