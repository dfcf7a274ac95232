// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Body of the photometric kernel; included by one file per instruction set,
// which defines FACET_KERNEL_NAMESPACE. Loops over fixed-size lane arrays are
// written for the vectoriser: no branches, no calls, selects by arithmetic.
// Nothing of the standard library is instantiated here: the linker could keep
// the copy compiled for the newest processor for the whole program.
#include "costs/photo_kernel.h"

namespace facet {
namespace FACET_KERNEL_NAMESPACE {

constexpr int kLanes = 64;
constexpr float kMinDepth = 0.05f;  // [m]

inline int ChunkSize(size_t left) {
  return left < kLanes ? static_cast<int>(left) : kLanes;
}

struct alignas(64) Lane {
  float v[kLanes];
};

// All that one chunk of observations needs.
struct Chunk {
  Lane qx, qy, qz, color;       // input points
  Lane x, y, z;                 // camera coordinates
  Lane u, v;                    // warped pixel
  Lane d00, d10, d01, d11;      // warp weights
  Lane dxx, dxy, dyx, dyy;      // D = dF/du, row-major
  Lane value, ix, iy;           // I and its gradient at F(u)
  Lane valid;                   // 1, or 0 in the padding
};

inline void Load(const PhotoTexel* texels,
                 const uint32_t* ids,
                 int m,
                 Chunk* c) {
  for (int i = 0; i < m; ++i) {
    const PhotoTexel& texel = texels[ids[i]];
    c->qx.v[i] = texel.x;
    c->qy.v[i] = texel.y;
    c->qz.v[i] = texel.z;
    c->color.v[i] = texel.color;
    c->valid.v[i] = 1;
  }
  for (int i = m; i < kLanes; ++i) {
    c->qx.v[i] = c->qx.v[0];
    c->qy.v[i] = c->qy.v[0];
    c->qz.v[i] = c->qz.v[0];
    c->color.v[i] = c->color.v[0];
    c->valid.v[i] = 0;
  }
}

// y = R q + t and u = pi(y). Counts points behind the camera.
inline void Project(const PhotoFrame& f, Chunk* c, PhotoCounts* counts) {
  float behind = 0;
  for (int i = 0; i < kLanes; ++i) {
    const float qx = c->qx.v[i], qy = c->qy.v[i], qz = c->qz.v[i];
    const float x = f.r[0] * qx + f.r[1] * qy + f.r[2] * qz + f.t[0];
    const float y = f.r[3] * qx + f.r[4] * qy + f.r[5] * qz + f.t[1];
    float z = f.r[6] * qx + f.r[7] * qy + f.r[8] * qz + f.t[2];
    behind += z < kMinDepth ? c->valid.v[i] : 0.0f;
    z = z < kMinDepth ? kMinDepth : z;
    const float inverse_z = 1.0f / z;
    c->x.v[i] = x;
    c->y.v[i] = y;
    c->z.v[i] = z;
    c->u.v[i] = f.fx * x * inverse_z + f.cx;
    c->v.v[i] = f.fy * y * inverse_z + f.cy;
  }
  counts->behind += static_cast<size_t>(behind);
}

// Bilinear weights, F and D inside the cell with the given four vertices.
inline void WarpInCell(const PhotoFrame& f,
                       float a,
                       float b,
                       const float f00[2],
                       const float f10[2],
                       const float f01[2],
                       const float f11[2],
                       Chunk* c) {
  for (int i = 0; i < kLanes; ++i) {
    const float al = c->u.v[i] * f.inverse_cell_width - a;
    const float be = c->v.v[i] * f.inverse_cell_height - b;
    const float w00 = (1 - al) * (1 - be), w10 = al * (1 - be);
    const float w01 = (1 - al) * be, w11 = al * be;
    c->d00.v[i] = w00;
    c->d10.v[i] = w10;
    c->d01.v[i] = w01;
    c->d11.v[i] = w11;
    c->dxx.v[i] = 1 + ((f10[0] - f00[0]) * (1 - be) + (f11[0] - f01[0]) * be) *
                          f.inverse_cell_width;
    c->dyx.v[i] = ((f10[1] - f00[1]) * (1 - be) + (f11[1] - f01[1]) * be) *
                  f.inverse_cell_width;
    c->dxy.v[i] = ((f01[0] - f00[0]) * (1 - al) + (f11[0] - f10[0]) * al) *
                  f.inverse_cell_height;
    c->dyy.v[i] = 1 + ((f01[1] - f00[1]) * (1 - al) + (f11[1] - f10[1]) * al) *
                          f.inverse_cell_height;
    c->u.v[i] += w00 * f00[0] + w10 * f10[0] + w01 * f01[0] + w11 * f11[0];
    c->v.v[i] += w00 * f00[1] + w10 * f10[1] + w01 * f01[1] + w11 * f11[1];
  }
}

// The same with every point in the cell it falls into.
inline void WarpAnywhere(const PhotoFrame& f, Chunk* c) {
  const int last_a = f.columns - 2, last_b = f.rows - 2;
  const float max_a = static_cast<float>(last_a);
  const float max_b = static_cast<float>(last_b);
  for (int i = 0; i < kLanes; ++i) {
    const float gx = c->u.v[i] * f.inverse_cell_width;
    const float gy = c->v.v[i] * f.inverse_cell_height;
    const float cx = gx > 0 ? (gx < max_a ? gx : max_a) : 0.0f;
    const float cy = gy > 0 ? (gy < max_b ? gy : max_b) : 0.0f;
    const int ai = static_cast<int>(cx), bi = static_cast<int>(cy);
    const float al = gx - static_cast<float>(ai);
    const float be = gy - static_cast<float>(bi);
    const int k = 2 * (bi * f.columns + ai), down = 2 * f.columns;
    const float f00x = f.warp[k], f00y = f.warp[k + 1];
    const float f10x = f.warp[k + 2], f10y = f.warp[k + 3];
    const float f01x = f.warp[k + down], f01y = f.warp[k + down + 1];
    const float f11x = f.warp[k + down + 2], f11y = f.warp[k + down + 3];
    c->dxx.v[i] = 1 + ((f10x - f00x) * (1 - be) + (f11x - f01x) * be) *
                          f.inverse_cell_width;
    c->dyx.v[i] = ((f10y - f00y) * (1 - be) + (f11y - f01y) * be) *
                  f.inverse_cell_width;
    c->dxy.v[i] = ((f01x - f00x) * (1 - al) + (f11x - f10x) * al) *
                  f.inverse_cell_height;
    c->dyy.v[i] = 1 + ((f01y - f00y) * (1 - al) + (f11y - f10y) * al) *
                          f.inverse_cell_height;
    const float w00 = (1 - al) * (1 - be), w10 = al * (1 - be);
    const float w01 = (1 - al) * be, w11 = al * be;
    c->u.v[i] += w00 * f00x + w10 * f10x + w01 * f01x + w11 * f11x;
    c->v.v[i] += w00 * f00y + w10 * f10y + w01 * f01y + w11 * f11y;
  }
}

// Bilinear value and its exact gradient, clamped to the image.
inline void SampleBilinear(const PhotoFrame& f,
                           Chunk* c,
                           PhotoCounts* counts) {
  const float max_u = static_cast<float>(f.width - 1);
  const float max_v = static_cast<float>(f.height - 1);
  const float max_x = static_cast<float>(f.width - 2);
  const float max_y = static_cast<float>(f.height - 2);
  const int stride = static_cast<int>(f.stride);
  const float* image = f.image;
  float clamped = 0;
  for (int i = 0; i < kLanes; ++i) {
    const float u = c->u.v[i], v = c->v.v[i];
    const float uc = u > 0 ? (u < max_u ? u : max_u) : 0.0f;
    const float vc = v > 0 ? (v < max_v ? v : max_v) : 0.0f;
    const float in_u = u == uc ? 1.0f : 0.0f;
    const float in_v = v == vc ? 1.0f : 0.0f;
    clamped += (1 - in_u * in_v) * c->valid.v[i];
    const int x = static_cast<int>(uc < max_x ? uc : max_x);
    const int y = static_cast<int>(vc < max_y ? vc : max_y);
    const float a = uc - static_cast<float>(x), b = vc - static_cast<float>(y);
    const int k = y * stride + x;
    const float i00 = image[k], i10 = image[k + 1];
    const float i01 = image[k + stride], i11 = image[k + stride + 1];
    const float top = i00 + a * (i10 - i00), bottom = i01 + a * (i11 - i01);
    c->value.v[i] = top + b * (bottom - top);
    c->ix.v[i] = in_u * ((i10 - i00) + b * ((i11 - i01) - (i10 - i00)));
    c->iy.v[i] = in_v * (bottom - top);
  }
  counts->clamped += static_cast<size_t>(clamped);
}

// The Scharr gradient images, interpolated, in place of the exact gradient.
__attribute__((noinline)) void SampleScharr(const PhotoFrame& f,
                                            Chunk* c,
                                            PhotoCounts* counts) {
  SampleBilinear(f, c, counts);
  const float max_u = static_cast<float>(f.width - 1);
  const float max_v = static_cast<float>(f.height - 1);
  const float max_x = static_cast<float>(f.width - 2);
  const float max_y = static_cast<float>(f.height - 2);
  const int stride = static_cast<int>(f.stride);
  const float *gx = f.gradient_x, *gy = f.gradient_y;
  for (int i = 0; i < kLanes; ++i) {
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
  const int last_x = f.width - 1, last_y = f.height - 1;
  const float* image = f.image;
  float clamped = 0;
  for (int i = 0; i < kLanes; ++i) {
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
    const int rows[4] = {y0 * stride, y * stride, (y + 1) * stride,
                         y3 * stride};
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
  float lost = 0;
  for (int i = 0; i < kLanes; ++i) {
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
    SampleBilinear(f, c, counts);
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

// Adds the Gram matrix of `n` columns (the last one is r) to `gram`.
inline void AddGram(const Lane* columns, int n, double* gram) {
  for (int i = 0; i < n; ++i) {
    for (int j = i; j < n; ++j) {
      float sum = 0;
      for (int k = 0; k < kLanes; ++k) {
        sum += columns[i].v[k] * columns[j].v[k];
      }
      gram[i * n + j] += static_cast<double>(sum);
    }
  }
}

inline void Residuals(const Chunk& c, Lane* r) {
  for (int i = 0; i < kLanes; ++i) {
    r->v[i] = (c.value.v[i] - c.color.v[i]) * c.valid.v[i];
  }
}

inline float SumSquares(const Lane& r) {
  float sum = 0;
  for (int i = 0; i < kLanes; ++i) sum += r.v[i] * r.v[i];
  return sum;
}

// Sum of rho(r^2). Residuals, and through `valid` the derivatives, become those
// of weighted least squares: times sqrt(rho').
__attribute__((noinline)) float ApplyLoss(const PhotoFrame& f,
                                          Lane* r,
                                          Chunk* c) {
  const float scale = f.loss_scale, c2 = scale * scale, inverse = 1.0f / c2;
  Lane rho, root;
  if (f.loss == LossKind::kHuber) {
    for (int i = 0; i < kLanes; ++i) {
      const float s = r->v[i] * r->v[i], length = __builtin_fabsf(r->v[i]);
      const bool inlier = length <= scale;
      rho.v[i] = inlier ? s : scale * (2 * length - scale);
      root.v[i] = __builtin_sqrtf(inlier ? 1.0f : scale / length);
    }
  } else if (f.loss == LossKind::kCauchy) {
    for (int i = 0; i < kLanes; ++i) {
      const float x = r->v[i] * r->v[i] * inverse;
      rho.v[i] = c2 * __builtin_log1pf(x);
      root.v[i] = __builtin_sqrtf(1.0f / (1.0f + x));
    }
  } else {
    for (int i = 0; i < kLanes; ++i) {
      const float x = r->v[i] * r->v[i] * inverse;
      const float y = x < 1 ? x : 1.0f;
      rho.v[i] = c2 / 3 * y * (3 + y * (y - 3));
      root.v[i] = 1 - y;
    }
  }
  float sum = 0;
  for (int i = 0; i < kLanes; ++i) {
    sum += rho.v[i];
    r->v[i] *= root.v[i];
    c->valid.v[i] *= root.v[i];
  }
  return sum;
}

// The cost of a chunk; prepares the residuals for the Gram matrix.
inline float CostOf(const PhotoFrame& f, Lane* r, Chunk* c) {
  return f.loss == LossKind::kSquared ? SumSquares(*r) : ApplyLoss(f, r, c);
}

// h = grad I D J_pi, the derivative of the intensity w.r.t. y.
inline void PointGradient(const PhotoFrame& f,
                          bool warped,
                          const Chunk& c,
                          Lane* ha,
                          Lane* hb,
                          Lane* hc) {
  for (int i = 0; i < kLanes; ++i) {
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
  const Lane &a = columns[3], &b = columns[4], &h = columns[5];
  for (int i = 0; i < kLanes; ++i) {
    columns[0].v[i] = c.y.v[i] * h.v[i] - c.z.v[i] * b.v[i];
    columns[1].v[i] = c.z.v[i] * a.v[i] - c.x.v[i] * h.v[i];
    columns[2].v[i] = c.x.v[i] * b.v[i] - c.y.v[i] * a.v[i];
  }
}

inline void WarpColumns(const Chunk& c, Lane* columns) {
  for (int i = 0; i < kLanes; ++i) {
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

// Bilinear and frozen: a loop of its own, in which nothing is computed that is
// not stored.
inline void SamplePlain(const PhotoFrame& frame,
                        const PhotoTexel* texels,
                        const uint32_t* ids,
                        size_t n,
                        float* intensity,
                        PhotoCounts* counts) {
  Chunk c;
  for (size_t begin = 0; begin < n; begin += kLanes) {
    const int m = ChunkSize(n - begin);
    Load(texels, ids + begin, m, &c);
    Project(frame, &c, counts);
    if (frame.warp) WarpAnywhere(frame, &c);
    SampleBilinear(frame, &c, counts);
    for (int i = 0; i < m; ++i) intensity[begin + i] = c.value.v[i];
  }
  counts->used += n;
}

void Sample(const PhotoFrame& frame,
            const PhotoTexel* texels,
            const uint32_t* ids,
            size_t n,
            float* intensity,
            PhotoCounts* counts) {
  if (frame.sampling == Sampling::kBilinear &&
      frame.out_of_image == OutOfImage::kFreeze) {
    SamplePlain(frame, texels, ids, n, intensity, counts);
    return;
  }
  Chunk c;
  for (size_t begin = 0; begin < n; begin += kLanes) {
    const int m = ChunkSize(n - begin);
    Load(texels, ids + begin, m, &c);
    Project(frame, &c, counts);
    if (frame.warp) WarpAnywhere(frame, &c);
    SampleImage(frame, &c, counts);
    StoreIntensity(frame, c, m, intensity + begin);
  }
  counts->used += n;
}

void SampleGradient(const PhotoFrame& frame,
                    const float e1[3],
                    const float e2[3],
                    const PhotoTexel* texels,
                    const uint32_t* ids,
                    size_t n,
                    float* intensity,
                    float* g1,
                    float* g2,
                    PhotoCounts* counts) {
  const float* r = frame.r;
  float a1[3], a2[3];  // R e1, R e2
  for (int k = 0; k < 3; ++k) {
    a1[k] = r[3 * k] * e1[0] + r[3 * k + 1] * e1[1] + r[3 * k + 2] * e1[2];
    a2[k] = r[3 * k] * e2[0] + r[3 * k + 1] * e2[1] + r[3 * k + 2] * e2[2];
  }
  Chunk c;
  Lane ha, hb, hc;
  for (size_t begin = 0; begin < n; begin += kLanes) {
    const int m = ChunkSize(n - begin);
    Load(texels, ids + begin, m, &c);
    Project(frame, &c, counts);
    if (frame.warp) WarpAnywhere(frame, &c);
    SampleImage(frame, &c, counts);
    PointGradient(frame, frame.warp != nullptr, c, &ha, &hb, &hc);
    StoreIntensity(frame, c, m, intensity + begin);
    for (int i = 0; i < m; ++i) {
      g1[begin + i] = ha.v[i] * a1[0] + hb.v[i] * a1[1] + hc.v[i] * a1[2];
      g2[begin + i] = ha.v[i] * a2[0] + hb.v[i] * a2[1] + hc.v[i] * a2[2];
    }
  }
  counts->used += n;
}

double FrameCell(const PhotoFrame& frame,
                 float a,
                 float b,
                 const PhotoTexel* texels,
                 const uint32_t* ids,
                 size_t n,
                 bool warp_columns,
                 double* gram,
                 PhotoCounts* counts) {
  const bool warped = frame.warp != nullptr;
  const int num_columns = warped && warp_columns ? 14 : 6;
  const float* f = frame.warp;
  Chunk c;
  Lane columns[15];
  double cost = 0;
  double* const corner = gram ? gram + GramSize(num_columns) - 1 : nullptr;
  const double before = gram ? *corner : 0;
  for (size_t begin = 0; begin < n; begin += kLanes) {
    const int m = ChunkSize(n - begin);
    Load(texels, ids + begin, m, &c);
    Project(frame, &c, counts);
    if (warped) {
      WarpInCell(frame, a, b, f, f + 2, f + 4, f + 6, &c);
    }
    SampleImage(frame, &c, counts);
    Residuals(c, &columns[num_columns]);
    cost += static_cast<double>(CostOf(frame, &columns[num_columns], &c));
    if (!gram) continue;
    PointGradient(frame, warped, c, &columns[3], &columns[4], &columns[5]);
    PoseColumns(c, columns);
    if (num_columns == 14) WarpColumns(c, columns + 6);
    AddGram(columns, num_columns + 1, gram);
  }
  if (gram && frame.loss != LossKind::kSquared) *corner = before + cost;
  counts->used += n;
  return cost;
}

// p -> q in place; keeps s and p - c for the Jacobian.
inline void ProjectOntoPlane(const float plane[4],
                             const float anchor[3],
                             Chunk* c,
                             Lane* s,
                             Lane* ax,
                             Lane* ay,
                             Lane* az) {
  for (int i = 0; i < kLanes; ++i) {
    const float dx = c->qx.v[i] - anchor[0], dy = c->qy.v[i] - anchor[1];
    const float dz = c->qz.v[i] - anchor[2];
    const float d = plane[0] * dx + plane[1] * dy + plane[2] * dz + plane[3];
    ax->v[i] = dx;
    ay->v[i] = dy;
    az->v[i] = dz;
    s->v[i] = d;
    c->qx.v[i] -= d * plane[0];
    c->qy.v[i] -= d * plane[1];
    c->qz.v[i] -= d * plane[2];
  }
}

double PlaneSegment(const PhotoFrame& frame,
                    const float plane[4],
                    const float anchor[3],
                    const PhotoTexel* texels,
                    const uint32_t* ids,
                    size_t n,
                    double* gram,
                    PhotoCounts* counts) {
  Chunk c;
  Lane s, ax, ay, az, ha, hb, hc;
  Lane columns[5];
  double cost = 0;
  double* const corner = gram ? gram + GramSize(4) - 1 : nullptr;
  const double before = gram ? *corner : 0;
  const float* r = frame.r;
  for (size_t begin = 0; begin < n; begin += kLanes) {
    const int m = ChunkSize(n - begin);
    Load(texels, ids + begin, m, &c);
    ProjectOntoPlane(plane, anchor, &c, &s, &ax, &ay, &az);
    Project(frame, &c, counts);
    if (frame.warp) WarpAnywhere(frame, &c);
    SampleImage(frame, &c, counts);
    Residuals(c, &columns[4]);
    cost += static_cast<double>(CostOf(frame, &columns[4], &c));
    if (!gram) continue;
    PointGradient(frame, frame.warp != nullptr, c, &ha, &hb, &hc);
    for (int i = 0; i < kLanes; ++i) {
      const float a = ha.v[i], b = hb.v[i], h = hc.v[i];
      const float gx = a * r[0] + b * r[3] + h * r[6];  // h R
      const float gy = a * r[1] + b * r[4] + h * r[7];
      const float gz = a * r[2] + b * r[5] + h * r[8];
      const float gn = gx * plane[0] + gy * plane[1] + gz * plane[2];
      columns[0].v[i] = -(gn * ax.v[i] + s.v[i] * gx);
      columns[1].v[i] = -(gn * ay.v[i] + s.v[i] * gy);
      columns[2].v[i] = -(gn * az.v[i] + s.v[i] * gz);
      columns[3].v[i] = -gn;
    }
    AddGram(columns, 5, gram);
  }
  if (gram && frame.loss != LossKind::kSquared) *corner = before + cost;
  counts->used += n;
  return cost;
}

extern const PhotoKernel kKernel;
const PhotoKernel kKernel = {FACET_KERNEL_NAME, Sample, SampleGradient,
                             FrameCell, PlaneSegment};

}  // namespace FACET_KERNEL_NAMESPACE
}  // namespace facet
