// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Part of photo_kernel_impl.h: what the image holds at the pixels of a chunk,
// one function per Sampling and OutOfImage (problems/formulation.h).
#pragma once

namespace facet {
namespace FACET_KERNEL_NAMESPACE {

// Bilinear value and, if asked for, its exact gradient, clamped to the image.
template <bool kWithGradient>
inline void SampleBilinear(const PhotoFrame& f, Chunk* c, PhotoCounts* counts) {
  const float max_u = static_cast<float>(f.width - 1);
  const float max_v = static_cast<float>(f.height - 1);
  const float max_x = static_cast<float>(f.width - 2);
  const float max_y = static_cast<float>(f.height - 2);
  const int stride = static_cast<int>(f.stride);
  const int lanes = LanesOf(*c);
  const float* image = f.image;
  float clamped = 0;
  // Neighbouring texels of a tile lie two pixels apart: most rows of an image
  // are touched once and come from memory. All are asked for before any is
  // waited for.
  for (int i = 0; i < lanes; ++i) {
    const float u = c->u.v[i], v = c->v.v[i];
    const float uc = u > 0 ? (u < max_x ? u : max_x) : 0.0f;
    const float vc = v > 0 ? (v < max_y ? v : max_y) : 0.0f;
    c->pixel[i] = static_cast<int>(vc) * stride + static_cast<int>(uc);
  }
  for (int i = 0; i < lanes; ++i) {
    __builtin_prefetch(image + c->pixel[i]);
    __builtin_prefetch(image + c->pixel[i] + stride);
  }
  for (int i = 0; i < lanes; ++i) {
    const float u = c->u.v[i], v = c->v.v[i];
    const float uc = u > 0 ? (u < max_u ? u : max_u) : 0.0f;
    const float vc = v > 0 ? (v < max_v ? v : max_v) : 0.0f;
    const float in_u = u == uc ? 1.0f : 0.0f;
    const float in_v = v == vc ? 1.0f : 0.0f;
    clamped += (1 - in_u * in_v) * c->valid.v[i];
    const int x = static_cast<int>(uc < max_x ? uc : max_x);
    const int y = static_cast<int>(vc < max_y ? vc : max_y);
    const float a = uc - static_cast<float>(x), b = vc - static_cast<float>(y);
    const int k = c->pixel[i];
    const float i00 = image[k], i10 = image[k + 1];
    const float i01 = image[k + stride], i11 = image[k + stride + 1];
    const float top = i00 + a * (i10 - i00), bottom = i01 + a * (i11 - i01);
    c->value.v[i] = top + b * (bottom - top);
    if (kWithGradient) {
      c->ix.v[i] = in_u * ((i10 - i00) + b * ((i11 - i01) - (i10 - i00)));
      c->iy.v[i] = in_v * (bottom - top);
    }
  }
  counts->clamped += static_cast<size_t>(clamped);
}

// The Scharr gradient images, interpolated, in place of the exact gradient.
__attribute__((noinline)) void SampleScharr(const PhotoFrame& f,
                                            Chunk* c,
                                            PhotoCounts* counts) {
  SampleBilinear<false>(f, c, counts);
  const float max_u = static_cast<float>(f.width - 1);
  const float max_v = static_cast<float>(f.height - 1);
  const float max_x = static_cast<float>(f.width - 2);
  const float max_y = static_cast<float>(f.height - 2);
  const int stride = static_cast<int>(f.stride);
  const int lanes = LanesOf(*c);
  const float *gx = f.gradient_x, *gy = f.gradient_y;
  for (int i = 0; i < lanes; ++i) {
    const float u = c->u.v[i], v = c->v.v[i];
    const float uc = u > 0 ? (u < max_u ? u : max_u) : 0.0f;
    const float vc = v > 0 ? (v < max_v ? v : max_v) : 0.0f;
    const int x = static_cast<int>(uc < max_x ? uc : max_x);
    const int y = static_cast<int>(vc < max_y ? vc : max_y);
    const float a = uc - static_cast<float>(x), b = vc - static_cast<float>(y);
    const int k = y * stride + x;
    const float w00 = (1 - a) * (1 - b), w10 = a * (1 - b);
    const float w01 = (1 - a) * b, w11 = a * b;
    c->ix.v[i] = (u == uc ? 1.0f : 0.0f) *
                 (w00 * gx[k] + w10 * gx[k + 1] + w01 * gx[k + stride] +
                  w11 * gx[k + stride + 1]);
    c->iy.v[i] = (v == vc ? 1.0f : 0.0f) *
                 (w00 * gy[k] + w10 * gy[k + 1] + w01 * gy[k + stride] +
                  w11 * gy[k + stride + 1]);
  }
}

// Catmull-Rom value and gradient (geometry/image_sampler.h: SampleBicubic).
__attribute__((noinline)) void SampleBicubic(const PhotoFrame& f,
                                             Chunk* c,
                                             PhotoCounts* counts) {
  const float max_u = static_cast<float>(f.width - 1);
  const float max_v = static_cast<float>(f.height - 1);
  const float max_x = static_cast<float>(f.width - 2);
  const float max_y = static_cast<float>(f.height - 2);
  const int stride = static_cast<int>(f.stride);
  const int lanes = LanesOf(*c);
  const int last_x = f.width - 1, last_y = f.height - 1;
  const float* image = f.image;
  float clamped = 0;
  for (int i = 0; i < lanes; ++i) {
    const float u = c->u.v[i], v = c->v.v[i];
    const float uc = u > 0 ? (u < max_u ? u : max_u) : 0.0f;
    const float vc = v > 0 ? (v < max_v ? v : max_v) : 0.0f;
    const float in_u = u == uc ? 1.0f : 0.0f;
    const float in_v = v == vc ? 1.0f : 0.0f;
    clamped += (1 - in_u * in_v) * c->valid.v[i];
    const int x = static_cast<int>(uc < max_x ? uc : max_x);
    const int y = static_cast<int>(vc < max_y ? vc : max_y);
    const float a = uc - static_cast<float>(x), b = vc - static_cast<float>(y);
    const int x0 = x > 0 ? x - 1 : 0, x3 = x + 2 < last_x ? x + 2 : last_x;
    const int y0 = y > 0 ? y - 1 : 0, y3 = y + 2 < last_y ? y + 2 : last_y;
    const float w0 = a * (-0.5f + a * (1 - 0.5f * a));
    const float w1 = 1 + a * a * (-2.5f + 1.5f * a);
    const float w2 = a * (0.5f + a * (2 - 1.5f * a));
    const float w3 = a * a * (-0.5f + 0.5f * a);
    const float d0 = -0.5f + a * (2 - 1.5f * a), d1 = a * (-5 + 4.5f * a);
    const float d2 = 0.5f + a * (4 - 4.5f * a), d3 = a * (-1 + 1.5f * a);
    const int rows[4] = {
        y0 * stride, y * stride, (y + 1) * stride, y3 * stride};
    const float v0 = b * (-0.5f + b * (1 - 0.5f * b));
    const float v1 = 1 + b * b * (-2.5f + 1.5f * b);
    const float v2 = b * (0.5f + b * (2 - 1.5f * b));
    const float v3 = b * b * (-0.5f + 0.5f * b);
    const float e0 = -0.5f + b * (2 - 1.5f * b), e1 = b * (-5 + 4.5f * b);
    const float e2 = 0.5f + b * (4 - 4.5f * b), e3 = b * (-1 + 1.5f * b);
    const float wv[4] = {v0, v1, v2, v3}, ev[4] = {e0, e1, e2, e3};
    float value = 0, dx = 0, dy = 0;
    for (int j = 0; j < 4; ++j) {
      const float i0 = image[rows[j] + x0], i1 = image[rows[j] + x];
      const float i2 = image[rows[j] + x + 1], i3 = image[rows[j] + x3];
      const float p = w0 * i0 + w1 * i1 + w2 * i2 + w3 * i3;
      value += wv[j] * p;
      dy += ev[j] * p;
      dx += wv[j] * (d0 * i0 + d1 * i1 + d2 * i2 + d3 * i3);
    }
    c->value.v[i] = value;
    c->ix.v[i] = in_u * dx;
    c->iy.v[i] = in_v * dy;
  }
  counts->clamped += static_cast<size_t>(clamped);
}

// Samples outside the image or behind the camera lose their residual.
__attribute__((noinline)) void DropOutside(const PhotoFrame& f,
                                           Chunk* c,
                                           PhotoCounts* counts) {
  const float max_u = static_cast<float>(f.width - 1);
  const float max_v = static_cast<float>(f.height - 1);
  const int lanes = LanesOf(*c);
  float lost = 0;
  for (int i = 0; i < lanes; ++i) {
    const float u = c->u.v[i], v = c->v.v[i];
    const bool inside = (u >= 0) & (u <= max_u) & (v >= 0) & (v <= max_v) &
                        (c->z.v[i] > kMinDepth);
    lost += inside ? 0.0f : c->valid.v[i];
    c->valid.v[i] = inside ? c->valid.v[i] : 0.0f;
  }
  counts->lost += static_cast<size_t>(lost);
}

// The other ways are chosen a chunk at a time: the bilinear loop stays as fast
// as if it were alone.
inline void SampleImage(const PhotoFrame& f, Chunk* c, PhotoCounts* counts) {
  if (f.sampling == Sampling::kBilinear) {
    SampleBilinear<true>(f, c, counts);
  } else if (f.sampling == Sampling::kScharr) {
    SampleScharr(f, c, counts);
  } else {
    SampleBicubic(f, c, counts);
  }
  if (f.out_of_image == OutOfImage::kDrop) DropOutside(f, c, counts);
}

// Intensities to the caller; NaN where the sample is dropped.
inline void StoreIntensity(const PhotoFrame& f,
                           const Chunk& c,
                           int m,
                           float* __restrict intensity) {
  for (int i = 0; i < m; ++i) intensity[i] = c.value.v[i];
  if (f.out_of_image != OutOfImage::kDrop) return;
  for (int i = 0; i < m; ++i) {
    if (c.valid.v[i] == 0) intensity[i] = __builtin_nanf("");
  }
}

}  // namespace FACET_KERNEL_NAMESPACE
}  // namespace facet
