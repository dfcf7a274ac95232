// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Part of photo_kernel_impl.h: residuals, losses, the columns of the Jacobian
// and their Gram matrix.
#pragma once

namespace facet {
namespace FACET_KERNEL_NAMESPACE {

// Adds the Gram matrix of `n` columns (the last one is r) to `gram`.
inline void AddGram(const Lane* columns, int n, int lanes, double* gram) {
  for (int i = 0; i < n; ++i) {
    for (int j = i; j < n; ++j) {
      float sum = 0;
      for (int k = 0; k < lanes; ++k) {
        sum += columns[i].v[k] * columns[j].v[k];
      }
      gram[i * n + j] += static_cast<double>(sum);
    }
  }
}

inline void Residuals(const Chunk& c, Lane* r) {
  const int lanes = LanesOf(c);
  for (int i = 0; i < lanes; ++i) {
    r->v[i] = (c.value.v[i] - c.color.v[i]) * c.valid.v[i];
  }
}

inline float SumSquares(const Lane& r, int lanes) {
  float sum = 0;
  for (int i = 0; i < lanes; ++i) sum += r.v[i] * r.v[i];
  return sum;
}

// Sum of rho(r^2). Residuals, and through `valid` the derivatives, become those
// of weighted least squares: times sqrt(rho').
__attribute__((noinline)) float ApplyLoss(const PhotoFrame& f,
                                          Lane* r,
                                          Chunk* c) {
  const float scale = f.loss_scale, c2 = scale * scale, inverse = 1.0f / c2;
  const int lanes = LanesOf(*c);
  Lane rho, root;
  if (f.loss == LossKind::kHuber) {
    for (int i = 0; i < lanes; ++i) {
      const float s = r->v[i] * r->v[i], length = __builtin_fabsf(r->v[i]);
      const bool inlier = length <= scale;
      rho.v[i] = inlier ? s : scale * (2 * length - scale);
      root.v[i] = __builtin_sqrtf(inlier ? 1.0f : scale / length);
    }
  } else if (f.loss == LossKind::kCauchy) {
    for (int i = 0; i < lanes; ++i) {
      const float x = r->v[i] * r->v[i] * inverse;
      rho.v[i] = c2 * __builtin_log1pf(x);
      root.v[i] = __builtin_sqrtf(1.0f / (1.0f + x));
    }
  } else {
    for (int i = 0; i < lanes; ++i) {
      const float x = r->v[i] * r->v[i] * inverse;
      const float y = x < 1 ? x : 1.0f;
      rho.v[i] = c2 / 3 * y * (3 + y * (y - 3));
      root.v[i] = 1 - y;
    }
  }
  float sum = 0;
  for (int i = 0; i < lanes; ++i) {
    sum += rho.v[i];
    r->v[i] *= root.v[i];
    c->valid.v[i] *= root.v[i];
  }
  return sum;
}

// The cost of a chunk; prepares the residuals for the Gram matrix.
inline float CostOf(const PhotoFrame& f, Lane* r, Chunk* c) {
  return f.loss == LossKind::kSquared ? SumSquares(*r, LanesOf(*c))
                                      : ApplyLoss(f, r, c);
}

// h = grad I D J_pi, the derivative of the intensity w.r.t. y.
inline void PointGradient(const PhotoFrame& f,
                          bool warped,
                          const Chunk& c,
                          Lane* ha,
                          Lane* hb,
                          Lane* hc) {
  const int lanes = LanesOf(c);
  for (int i = 0; i < lanes; ++i) {
    const float ix = c.ix.v[i] * c.valid.v[i], iy = c.iy.v[i] * c.valid.v[i];
    const float gx = warped ? ix * c.dxx.v[i] + iy * c.dyx.v[i] : ix;
    const float gy = warped ? ix * c.dxy.v[i] + iy * c.dyy.v[i] : iy;
    const float inverse_z = 1.0f / c.z.v[i];
    const float a = gx * f.fx * inverse_z, b = gy * f.fy * inverse_z;
    ha->v[i] = a;
    hb->v[i] = b;
    hc->v[i] = -(a * c.x.v[i] + b * c.y.v[i]) * inverse_z;
  }
}

inline void PoseColumns(const Chunk& c, Lane* columns) {
  const int lanes = LanesOf(c);
  const Lane &a = columns[3], &b = columns[4], &h = columns[5];
  for (int i = 0; i < lanes; ++i) {
    columns[0].v[i] = c.y.v[i] * h.v[i] - c.z.v[i] * b.v[i];
    columns[1].v[i] = c.z.v[i] * a.v[i] - c.x.v[i] * h.v[i];
    columns[2].v[i] = c.x.v[i] * b.v[i] - c.y.v[i] * a.v[i];
  }
}

inline void WarpColumns(const Chunk& c, Lane* columns) {
  const int lanes = LanesOf(c);
  for (int i = 0; i < lanes; ++i) {
    const float ix = c.ix.v[i] * c.valid.v[i], iy = c.iy.v[i] * c.valid.v[i];
    columns[0].v[i] = ix * c.d00.v[i];
    columns[1].v[i] = iy * c.d00.v[i];
    columns[2].v[i] = ix * c.d10.v[i];
    columns[3].v[i] = iy * c.d10.v[i];
    columns[4].v[i] = ix * c.d01.v[i];
    columns[5].v[i] = iy * c.d01.v[i];
    columns[6].v[i] = ix * c.d11.v[i];
    columns[7].v[i] = iy * c.d11.v[i];
  }
}

}  // namespace FACET_KERNEL_NAMESPACE
}  // namespace facet
