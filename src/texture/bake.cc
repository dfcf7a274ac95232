// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "texture/bake.h"

#include <algorithm>
#include <cmath>

#include "texture/bake_colors.h"
#include "texture/fill_texture.h"
#include "texture/rgb_sampler.h"
#include "util/errors.h"
#include "util/parallel_for.h"

namespace facet {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

const BakeOptions& Checked(const BakeOptions& options) {
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
  if (options.visibility_px < 1 || options.visibility_px > kBakeTilePx) {
    throw OptionsError("texels that share a visibility test must be 1 to " +
                       std::to_string(kBakeTilePx));
  }
  return options;
}

// Which texels of a tile any keyframe sees by the strict tests.
std::vector<uint64_t> SeenWell(const BakeTile& tile,
                               const std::vector<TileSights::View>& views) {
  std::vector<uint64_t> seen(TileSights::NumWords(tile), 0);
  for (const TileSights::View& view : views) {
    for (size_t w = 0; w < seen.size(); ++w) seen[w] |= view.words[w];
  }
  return seen;
}

bool HasBit(const uint64_t* words, uint32_t bit) {
  return words[bit / 64] >> (bit % 64) & 1;
}

// One keyframe, ready for lookups.
struct View {
  Eigen::Matrix3f rotation;
  Vector3f translation, center;
  const cv::Mat* rgb = nullptr;
  const float* warp = nullptr;  // null = none
  Exposure exposure;
  Eigen::Array3f inverse_gain, offset_over_gain;
  float sharpness = 1;
};

// Colours the tiles of one state.
class TilePainter {
 public:
  TilePainter(const TextureState& state,
              const Atlas& atlas,
              const Pinhole& camera,
              const WarpLattice& lattice,
              const BakeOptions& options,
              const BakeTexels& texels,
              const TileSights& sights)
      : state_(state),
        atlas_(atlas),
        camera_(camera),
        lattice_(lattice),
        warps_(state.warps.begin(), state.warps.end()),
        options_(options),
        texels_(texels),
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

  std::vector<cv::Mat> Paint(const std::vector<char>& only_faces,
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

 private:
  void MakeViews() {
    const std::vector<float> sharpness =
        Sharpness(state_.images, options_.sharpness_power);
    views_.resize(state_.color_cam_from_world.size());
    for (size_t k = 0; k < views_.size(); ++k) {
      const Pose& pose = state_.color_cam_from_world[k];
      View& view = views_[k];
      view.rotation = pose.RotationMatrix().cast<float>();
      view.translation = pose.translation.cast<float>();
      view.center = pose.CenterInSource().cast<float>();
      view.rgb = &state_.images.rgb[k];
      if (!warps_.empty()) {
        view.warp = warps_.data() + 2ul * lattice_.NumVertices() * k;
      }
      view.exposure = state_.images.ExposureOf(k);
      view.inverse_gain = view.exposure.gain.inverse();
      view.offset_over_gain =
          255.0f * view.exposure.offset * view.inverse_gain;
      view.sharpness = sharpness[k];
    }
  }

  bool IsWanted(const BakeTile& tile,
                const std::vector<char>& only_faces) const {
    if (only_faces.empty()) return true;
    const auto face = texels_.face.begin();
    return std::any_of(face + tile.begin, face + tile.owned_end, [&](int f) {
      return only_faces[f] != 0;
    });
  }

  BakeReport Total() const {
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
  float Powers(const View& view, const BakeTile& tile, uint32_t i, float z)
      const {
    const Vector3f normal = TexelNormal(state_.mesh,
                                        state_.planes,
                                        atlas_.charts[tile.chart],
                                        texels_,
                                        i);
    const float cosine =
        std::abs(normal.dot((view.center - texels_.q[i]).normalized()));
    return std::exp2(static_cast<float>(options_.angle_power) *
                         std::log2(std::max(cosine, 1e-3f)) -
                     static_cast<float>(options_.depth_power) * std::log2(z) +
                     static_cast<float>(options_.sharpness_power) *
                         std::log2(view.sharpness));
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

  float WeightAt(const View& view,
                 const BakeTile& tile,
                 uint32_t i,
                 const Vector2f& u,
                 float z) const {
    float weight = RampAt(u);
    if (has_powers_) weight *= Powers(view, tile, i, z);
    if (options_.best_view_power == 1) return weight;
    return std::exp2(static_cast<float>(options_.best_view_power) *
                     std::log2(weight));
  }

  // Calls use(i, colour, weight) for the texels of a tile that a keyframe
  // shows.
  template <typename Use>
  void LookUp(const BakeTile& tile,
              const TileSights::View& sight,
              const std::vector<uint64_t>& seen_well,
              const Use& use) const {
    const View& view = views_[sight.keyframe];
    const float fx = static_cast<float>(camera_.fx);
    const float fy = static_cast<float>(camera_.fy);
    const float cx = static_cast<float>(camera_.cx);
    const float cy = static_cast<float>(camera_.cy);
    const float right = static_cast<float>(camera_.width - 1);
    const float bottom = static_cast<float>(camera_.height - 1);
    const uint64_t* words[2] = {sight.words + seen_well.size(), sight.words};
    for (uint32_t i = tile.begin; i < tile.end; ++i) {
      const uint32_t bit = texels_.source[i] - tile.begin;
      if (!HasBit(words[HasBit(seen_well.data(), bit)], bit)) continue;
      const Vector3f y = view.rotation * texels_.q[i] + view.translation;
      if (!(y.z() > 0.01f)) continue;
      const float inverse_z = 1 / y.z();
      Vector2f u(fx * y.x() * inverse_z + cx, fy * y.y() * inverse_z + cy);
      if (view.warp) u = lattice_.Apply(view.warp, u);
      if (!(u.x() >= 0 && u.y() >= 0 && u.x() <= right && u.y() <= bottom)) {
        continue;
      }
      const Vector3f taken = options_.sampler == BakeSampler::kBilinear
                                 ? BilinearRgb(*view.rgb, u.x(), u.y())
                                 : BicubicRgb(*view.rgb, u.x(), u.y());
      use(i - tile.begin,
          view.exposure.Corrected(taken),
          WeightAt(view, tile, i, u, y.z()));
    }
  }

  void AddTo(ColorSum* sum,
             const View& view,
             const Vector3f& color,
             float weight) const {
    sum->Add(color, weight);
    if (exposure_share_ > 0) {
      sum->AddExposure(view.inverse_gain, view.offset_over_gain, weight);
    }
  }

  // The sums without outliers, for which all samples must be kept.
  void SumRobustly(const BakeTile& tile,
                   const std::vector<TileSights::View>& views,
                   const std::vector<uint64_t>& seen_well,
                   std::vector<ColorSum>* sums,
                   BakeReport* report) const {
    const size_t n = sums->size(), owned = tile.owned_end - tile.begin;
    std::vector<ColorSample> samples(n * views.size());
    for (size_t v = 0; v < views.size(); ++v) {
      LookUp(tile,
             views[v],
             seen_well,
             [&](size_t i, const Vector3f& color, float weight) {
               samples[n * v + i] = {color, weight};
               report->samples += i < owned;
             });
    }
    report->dropped = DropOutliers(n,
                                   owned,
                                   views.size(),
                                   static_cast<float>(options_.robust_luma),
                                   &samples);
    for (size_t v = 0; v < views.size(); ++v) {
      const View& view = views_[views[v].keyframe];
      for (size_t i = 0; i < n; ++i) {
        const ColorSample& sample = samples[n * v + i];
        if (sample.weight > 0) {
          AddTo(&(*sums)[i], view, sample.rgb, sample.weight);
        }
      }
    }
  }

  void PaintTile(size_t t) {
    const BakeTile& tile = texels_.tiles[t];
    BakeReport& report = reports_[t];
    const size_t owned = tile.owned_end - tile.begin;
    const std::vector<TileSights::View>& views = sights_.ViewsOf(t);
    const std::vector<uint64_t> seen_well = SeenWell(tile, views);
    std::vector<ColorSum> sums(tile.end - tile.begin);
    if (options_.robust_luma > 0) {
      SumRobustly(tile, views, seen_well, &sums, &report);
    } else {
      for (const TileSights::View& sight : views) {
        const View& view = views_[sight.keyframe];
        LookUp(tile,
               sight,
               seen_well,
               [&](size_t i, const Vector3f& color, float weight) {
                 AddTo(&sums[i], view, color, weight);
                 report.samples += i < owned;
               });
      }
    }
    for (size_t i = 0; i < sums.size(); ++i) {
      if (!(sums[i].weight > 0)) continue;
      colors_[tile.begin + i] = sums[i].Mean(exposure_share_);
      seen_[tile.begin + i] = 1;
      if (i >= owned) continue;
      ++report.seen;
      const uint32_t bit = texels_.source[tile.begin + i] - tile.begin;
      report.mild += !HasBit(seen_well.data(), bit);
    }
  }

  const TextureState& state_;
  const Atlas& atlas_;
  const Pinhole& camera_;
  const WarpLattice& lattice_;
  const std::vector<float> warps_;
  const BakeOptions& options_;
  const BakeTexels& texels_;
  const TileSights& sights_;
  const bool has_powers_;  // weights differ by more than the ramp
  const float exposure_share_;
  std::vector<View> views_;       // by keyframe
  std::vector<Vector3f> colors_;  // by texel
  std::vector<uint8_t> seen_;
  std::vector<BakeReport> reports_;  // by tile
};

}  // namespace

TextureBaker::TextureBaker(const TextureState& state,
                           const Atlas& atlas,
                           const RayScene& scene,
                           const RgbdSequence& sequence,
                           const std::vector<int>& keyframes,
                           const WarpLattice& lattice,
                           const VisibilityOptions& visibility,
                           const BakeOptions& options)
    : state_(state),
      atlas_(atlas),
      lattice_(lattice),
      camera_(sequence.calibration().color),
      options_(Checked(options)),
      texels_(MakeBakeTexels(state.mesh,
                             state.planes,
                             atlas,
                             options.ring_px,
                             options.visibility_px)),
      sights_(state.mesh,
              state.planes,
              atlas,
              texels_,
              scene,
              sequence,
              keyframes,
              state.color_cam_from_world,
              visibility,
              options.mild_fallback) {}

std::vector<cv::Mat> TextureBaker::Bake(BakeReport* report) const {
  return TilePainter(
             state_, atlas_, camera_, lattice_, options_, texels_, sights_)
      .Paint({}, report);
}

std::vector<cv::Mat> TextureBaker::BakeAs(const TextureState& state,
                                          const std::vector<char>& only_faces,
                                          BakeReport* report) const {
  const BakeTexels texels = MakeBakeTexels(state.mesh,
                                           state.planes,
                                           atlas_,
                                           options_.ring_px,
                                           options_.visibility_px);
  return TilePainter(
             state, atlas_, camera_, lattice_, options_, texels, sights_)
      .Paint(only_faces, report);
}

}  // namespace facet
