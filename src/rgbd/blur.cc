// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "rgbd/blur.h"

#include <algorithm>
#include <cmath>

namespace facet {
namespace {

constexpr int kRadius = 4;
constexpr int kTaps = 2 * kRadius + 1;
constexpr float kPerTap = 1.0f / kTaps;

// Half-sample mirror: ... 1 0 | 0 1 2 ... n-1 | n-1 n-2 ...
int Mirror(int i, int n) {
  const int period = 2 * n;
  i = ((i % period) + period) % period;
  return i < n ? i : period - 1 - i;
}

// Sums of |dF| and of min(|dF|, |dB|) along one direction. Neighbouring box
// means share all but their outermost taps, so the difference of the blurred
// image needs no blurred image:
//   B(i) - B(i-1) = (F(i+4) - F(i-5)) / 9.
struct Sums {
  double sharp = 0, common = 0;

  void Add(float here, float before, float ahead, float behind) {
    const float d_f = std::abs(here - before);
    sharp += d_f;
    common += std::min(d_f, std::abs(ahead - behind) * kPerTap);
  }

  // The same for `n` consecutive pixels. Lanes of their own let the compiler
  // vectorise the sums without changing their order.
  void AddRow(const float* here,
              const float* before,
              const float* ahead,
              const float* behind,
              int n) {
    constexpr int kLanes = 8;
    float lane_sharp[kLanes] = {}, lane_common[kLanes] = {};
    int i = 0;
    for (; i + kLanes <= n; i += kLanes) {
      for (int k = 0; k < kLanes; ++k) {
        const float d_f = std::abs(here[i + k] - before[i + k]);
        const float d_b = std::abs(ahead[i + k] - behind[i + k]) * kPerTap;
        lane_sharp[k] += d_f;
        lane_common[k] += d_b < d_f ? d_b : d_f;
      }
    }
    for (int k = 0; k < kLanes; ++k) {
      sharp += lane_sharp[k];
      common += lane_common[k];
    }
    for (; i < n; ++i) Add(here[i], before[i], ahead[i], behind[i]);
  }

  // (s_F - s_V) / s_F with V = max(0, dF - dB) = dF - min(dF, dB).
  double Blur() const { return sharp > 0 ? common / sharp : 1.0; }
};

}  // namespace

double CreteBlur(const ImageView<float>& luma) {
  const int width = luma.width, height = luma.height;
  // Columns [inner_begin, inner_end) need no mirror along x.
  const int inner_begin = std::min(kRadius + 1, width);
  const int inner_end = std::max(width - kRadius, inner_begin);
  Sums along_x, along_y;
  for (int y = 1; y < height; ++y) {
    const float* row = luma.data + y * luma.stride;
    const float* ahead = luma.data + Mirror(y + kRadius, height) * luma.stride;
    const float* behind =
        luma.data + Mirror(y - kRadius - 1, height) * luma.stride;
    along_y.AddRow(
        row + 1, row + 1 - luma.stride, ahead + 1, behind + 1, width - 1);
    const auto add_mirrored = [&](int begin, int end) {
      for (int x = begin; x < end; ++x) {
        along_x.Add(row[x],
                    row[x - 1],
                    row[Mirror(x + kRadius, width)],
                    row[Mirror(x - kRadius - 1, width)]);
      }
    };
    add_mirrored(1, inner_begin);
    along_x.AddRow(row + inner_begin,
                   row + inner_begin - 1,
                   row + inner_begin + kRadius,
                   row + inner_begin - kRadius - 1,
                   inner_end - inner_begin);
    add_mirrored(inner_end, width);
  }
  return std::max(along_x.Blur(), along_y.Blur());
}

}  // namespace facet
