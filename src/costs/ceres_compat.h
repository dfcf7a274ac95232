// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Image sampling for ceres::Jet: value and gradient of the sampler through the
// chain rule. Lets autodiff functors read images.
#pragma once

#include <ceres/jet.h>

#include "geometry/image_sampler.h"

namespace facet {

inline double SampleImage(const SampledImage& image, double u, double v) {
  return SampleAt(image, u, v).value;
}

inline double ScalarPart(double x) { return x; }

template <int N>
double ScalarPart(const ceres::Jet<double, N>& x) {
  return x.a;
}

template <int N>
ceres::Jet<double, N> SampleImage(const SampledImage& image,
                                  const ceres::Jet<double, N>& u,
                                  const ceres::Jet<double, N>& v) {
  const Sample s = SampleAt(image, u.a, v.a);
  return ceres::Jet<double, N>(s.value, s.dx * u.v + s.dy * v.v);
}

}  // namespace facet
