// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Body of the photometric kernel; included by one file per instruction set,
// which defines FACET_KERNEL_NAMESPACE. Loops over fixed-size lane arrays are
// written for the vectoriser: no branches, no calls, selects by arithmetic.
// Nothing of the standard library is instantiated here: the linker could keep
// the copy compiled for the newest processor for the whole program.
#include "costs/photo_kernel.h"
// In this order: each builds on those before.
// clang-format off
#include "costs/photo_kernel_lanes.h"
#include "costs/photo_kernel_samplers.h"
#include "costs/photo_kernel_columns.h"
// clang-format on

namespace facet {
namespace FACET_KERNEL_NAMESPACE {

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
    if (frame.warp) WarpAnywhere<false>(frame, &c);
    SampleBilinear<false>(frame, &c, counts);
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
    if (frame.warp) WarpAnywhere<false>(frame, &c);
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
    if (frame.warp) WarpAnywhere<true>(frame, &c);
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

// Byte k of a pixel as a number.
template <int k>
float Byte(uint32_t pixel) {
  return static_cast<float>(pixel >> 8 * k & 255);
}

// The first byte is the lowest: all processors that facet runs on are little
// endian.
inline uint32_t FourBytes(const uint8_t* p) {
  uint32_t bytes;
  __builtin_memcpy(&bytes, p, sizeof(bytes));
  return bytes;
}

void SampleRgb(const PhotoFrame& frame,
               const uint8_t* rgb,
               ptrdiff_t row_bytes,
               const PhotoTexel* texels,
               const uint32_t* ids,
               size_t n,
               const PhotoColors& out) {
  const float max_u = static_cast<float>(frame.width - 1);
  const float max_v = static_cast<float>(frame.height - 1);
  const float max_x = static_cast<float>(frame.width - 2);
  const float max_y = static_cast<float>(frame.height - 2);
  const int stride = static_cast<int>(row_bytes);
  PhotoCounts counts;
  Chunk c;
  Lane a, b, red, green, blue;
  alignas(64) uint32_t p00[kLanes], p10[kLanes], p01[kLanes], p11[kLanes];
  for (size_t begin = 0; begin < n; begin += kLanes) {
    const int m = ChunkSize(n - begin);
    Load(texels, ids + begin, m, &c);
    Project(frame, &c, &counts);
    if (frame.warp) WarpAnywhere<false>(frame, &c);
    const int lanes = LanesOf(c);
    alignas(64) int offset[kLanes];
    for (int i = 0; i < lanes; ++i) {
      const float u = c.u.v[i], v = c.v.v[i];
      const float uc = u > 0 ? (u < max_u ? u : max_u) : 0.0f;
      const float vc = v > 0 ? (v < max_v ? v : max_v) : 0.0f;
      const int x = static_cast<int>(uc < max_x ? uc : max_x);
      const int y = static_cast<int>(vc < max_y ? vc : max_y);
      offset[i] = y * stride + 3 * x;
      a.v[i] = uc - static_cast<float>(x);
      b.v[i] = vc - static_cast<float>(y);
    }
    // The right pixel with the byte before it, so that nothing behind the image
    // is read.
    for (int i = 0; i < lanes; ++i) {
      const uint8_t* at = rgb + offset[i];
      p00[i] = FourBytes(at);
      p10[i] = FourBytes(at + 2);
      p01[i] = FourBytes(at + stride);
      p11[i] = FourBytes(at + stride + 2);
    }
    for (int i = 0; i < lanes; ++i) {
      const float w00 = (1 - a.v[i]) * (1 - b.v[i]);
      const float w10 = a.v[i] * (1 - b.v[i]);
      const float w01 = (1 - a.v[i]) * b.v[i], w11 = a.v[i] * b.v[i];
      red.v[i] = w00 * Byte<0>(p00[i]) + w10 * Byte<1>(p10[i]) +
                 w01 * Byte<0>(p01[i]) + w11 * Byte<1>(p11[i]);
      green.v[i] = w00 * Byte<1>(p00[i]) + w10 * Byte<2>(p10[i]) +
                   w01 * Byte<1>(p01[i]) + w11 * Byte<2>(p11[i]);
      blue.v[i] = w00 * Byte<2>(p00[i]) + w10 * Byte<3>(p10[i]) +
                  w01 * Byte<2>(p01[i]) + w11 * Byte<3>(p11[i]);
    }
    for (int i = 0; i < m; ++i) {
      out.u[begin + i] = c.u.v[i];
      out.v[begin + i] = c.v.v[i];
      out.red[begin + i] = red.v[i];
      out.green[begin + i] = green.v[i];
      out.blue[begin + i] = blue.v[i];
    }
  }
}

// Samples of weight 0 may have no intensity: they count as residual 0.
void ViewSums(const float* intensity,
              const float* g1,
              const float* g2,
              const float* weight,
              const PhotoPatchTexel* texels,
              const uint32_t* ids,
              uint32_t first,
              size_t n,
              const float ray[3],
              PhotoViewSums* sums) {
  Lane r, e1, e2, s;
  const float inverse = -1.0f / ray[2];
  PhotoViewSums t = {};
  for (size_t begin = 0; begin < n; begin += kLanes) {
    const int m = ChunkSize(n - begin);
    for (int i = 0; i < m; ++i) {
      const PhotoPatchTexel& texel = texels[ids[begin + i] - first];
      e1.v[i] = texel.e1;
      e2.v[i] = texel.e2;
      s.v[i] = texel.s;
      r.v[i] = intensity[begin + i] - texel.color;
    }
    if (weight) {
      for (int i = 0; i < m; ++i) {
        const float w = weight[begin + i];
        r.v[i] = w == 0 ? 0.0f : w * r.v[i];
      }
    }
    for (int i = 0; i < m; ++i) {
      const float a = e1.v[i], b = e2.v[i];
      const float h1 = r.v[i] * g1[begin + i], h2 = r.v[i] * g2[begin + i];
      const float hn = (h1 * (ray[0] + a) + h2 * (ray[1] + b)) * inverse;
      t.squares += r.v[i] * r.v[i];
      t.g1 += h1;
      t.g2 += h2;
      t.gn += hn;
      t.e1_g2 += a * h2;
      t.e1_gn += a * hn;
      t.e2_g1 += b * h1;
      t.e2_gn += b * hn;
      t.s_g1 += s.v[i] * h1;
      t.s_g2 += s.v[i] * h2;
      t.s_gn += s.v[i] * hn;
    }
  }
  *sums = t;
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
    AddGram(columns, num_columns + 1, LanesOf(c), gram);
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
  const int lanes = LanesOf(*c);
  for (int i = 0; i < lanes; ++i) {
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
    if (frame.warp) WarpAnywhere<true>(frame, &c);
    SampleImage(frame, &c, counts);
    Residuals(c, &columns[4]);
    cost += static_cast<double>(CostOf(frame, &columns[4], &c));
    if (!gram) continue;
    PointGradient(frame, frame.warp != nullptr, c, &ha, &hb, &hc);
    const int lanes = LanesOf(c);
    for (int i = 0; i < lanes; ++i) {
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
    AddGram(columns, 5, lanes, gram);
  }
  if (gram && frame.loss != LossKind::kSquared) *corner = before + cost;
  counts->used += n;
  return cost;
}

extern const PhotoKernel kKernel;
const PhotoKernel kKernel = {FACET_KERNEL_NAME,
                             Sample,
                             SampleGradient,
                             SampleRgb,
                             ViewSums,
                             FrameCell,
                             PlaneSegment};

}  // namespace FACET_KERNEL_NAMESPACE
}  // namespace facet
