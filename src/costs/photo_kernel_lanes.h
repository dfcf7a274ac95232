// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Part of photo_kernel_impl.h: lanes of observations, from texel to warped
// pixel.
#pragma once

#include "costs/photo_kernel.h"

namespace facet {
namespace FACET_KERNEL_NAMESPACE {

constexpr int kLanes = 64;
constexpr float kMinDepth = 0.05f;  // [m]

inline int ChunkSize(size_t left) {
  return left < kLanes ? static_cast<int>(left) : kLanes;
}

// Work is done on a multiple of so many: short chunks are common.
constexpr int kStep = 16;

struct alignas(64) Lane {
  float v[kLanes];
};

// All that one chunk of observations needs.
struct Chunk {
  Lane qx, qy, qz, color;         // input points
  Lane x, y, z;                   // camera coordinates
  Lane u, v;                      // warped pixel
  Lane d00, d10, d01, d11;        // warp weights
  Lane dxx, dxy, dyx, dyy;        // D = dF/du, row-major
  Lane value, ix, iy;             // I and its gradient at F(u)
  Lane valid;                     // 1, or 0 in the padding
  alignas(64) int pixel[kLanes];  // index of the upper left of four pixels
  int lanes;                      // in use, padding included
};

// Of lanes that are a multiple of kStep, as the compiler should know.
inline int LanesOf(const Chunk& c) { return c.lanes & -kStep; }

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
  c->lanes = (m + kStep - 1) & -kStep;
  for (int i = m; i < c->lanes; ++i) {
    c->qx.v[i] = c->qx.v[0];
    c->qy.v[i] = c->qy.v[0];
    c->qz.v[i] = c->qz.v[0];
    c->color.v[i] = c->color.v[0];
    c->valid.v[i] = 0;
  }
}

// y = R q + t and u = pi(y). Counts points behind the camera.
inline void Project(const PhotoFrame& f, Chunk* c, PhotoCounts* counts) {
  const int lanes = LanesOf(*c);
  float behind = 0;
  for (int i = 0; i < lanes; ++i) {
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
  const int lanes = LanesOf(*c);
  for (int i = 0; i < lanes; ++i) {
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

// The same with every point in the cell it falls into; D only if asked for.
template <bool kWithDerivative>
inline void WarpAnywhere(const PhotoFrame& f, Chunk* c) {
  const int last_a = f.columns - 2, last_b = f.rows - 2;
  const float max_a = static_cast<float>(last_a);
  const float max_b = static_cast<float>(last_b);
  const int lanes = LanesOf(*c);
  Lane shift_u, shift_v;
  for (int i = 0; i < lanes; ++i) {
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
    if (kWithDerivative) {
      c->dxx.v[i] = 1 + ((f10x - f00x) * (1 - be) + (f11x - f01x) * be) *
                            f.inverse_cell_width;
      c->dyx.v[i] = ((f10y - f00y) * (1 - be) + (f11y - f01y) * be) *
                    f.inverse_cell_width;
      c->dxy.v[i] = ((f01x - f00x) * (1 - al) + (f11x - f10x) * al) *
                    f.inverse_cell_height;
      c->dyy.v[i] = 1 + ((f01y - f00y) * (1 - al) + (f11y - f10y) * al) *
                            f.inverse_cell_height;
    }
    const float w00 = (1 - al) * (1 - be), w10 = al * (1 - be);
    const float w01 = (1 - al) * be, w11 = al * be;
    shift_u.v[i] = w00 * f00x + w10 * f10x + w01 * f01x + w11 * f11x;
    shift_v.v[i] = w00 * f00y + w10 * f10y + w01 * f01y + w11 * f11y;
  }
  // A loop of its own: -fassociative-math could add the terms one by one to
  // pixel coordinates, which are a hundred times as large, and round each time.
  for (int i = 0; i < lanes; ++i) {
    c->u.v[i] += shift_u.v[i];
    c->v.v[i] += shift_v.v[i];
  }
}

}  // namespace FACET_KERNEL_NAMESPACE
}  // namespace facet
