// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Image sampling for ceres::Jet: value and gradient of the sampler through the
// chain rule. Lets autodiff functors read images.
#pragma once

#include <ceres/jet.h>

#include "geometry/image_sampler.h"

namespace facet {

inline double SampleImage(const ImageView<float>& image, double u, double v) {
  return SampleBilinear(image, u, v).value;
}

template <int N>
ceres::Jet<double, N> SampleImage(const ImageView<float>& image,
                                  const ceres::Jet<double, N>& u,
                                  const ceres::Jet<double, N>& v) {
  const Sample s = SampleBilinear(image, u.a, v.a);
  return ceres::Jet<double, N>(s.value, s.dx * u.v + s.dy * v.v);
}

}  // namespace facet
