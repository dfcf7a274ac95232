// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "rgbd/blur.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace facet {
namespace {

constexpr int kRadius = 4;  // box of 2 * 4 + 1 = 9 taps

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
    const float d_b = std::abs(ahead - behind) / (2 * kRadius + 1);
    sharp += d_f;
    common += std::min(d_f, d_b);
  }
  // (s_F - s_V) / s_F with V = max(0, dF - dB) = dF - min(dF, dB).
  double Blur() const { return sharp > 0 ? common / sharp : 1.0; }
};

}  // namespace

double CreteBlur(const ImageView<float>& luma) {
  const int width = luma.width, height = luma.height;
  std::vector<int> ahead(std::max(width, 0)), behind(std::max(width, 0));
  for (int x = 0; x < width; ++x) {
    ahead[x] = Mirror(x + kRadius, width);
    behind[x] = Mirror(x - kRadius - 1, width);
  }
  Sums along_x, along_y;
  for (int y = 1; y < height; ++y) {
    const float* row = luma.data + y * luma.stride;
    const float* above = row - luma.stride;
    const float* row_ahead =
        luma.data + Mirror(y + kRadius, height) * luma.stride;
    const float* row_behind =
        luma.data + Mirror(y - kRadius - 1, height) * luma.stride;
    for (int x = 1; x < width; ++x) {
      along_x.Add(row[x], row[x - 1], row[ahead[x]], row[behind[x]]);
      along_y.Add(row[x], above[x], row_ahead[x], row_behind[x]);
    }
  }
  return std::max(along_x.Blur(), along_y.Blur());
}

}  // namespace facet
