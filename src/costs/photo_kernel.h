// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// The photometric kernel: intensities, residuals and Gram matrices of many
// observations at once, in float SIMD lanes with double sums.
//
//   r = I(F(pi(R q + t))) - C,   q = p - (n.(p - c) + d) n
//
// The file photo_kernel_impl.h is compiled once per instruction set and chosen
// at run time, so that a portable build is fast everywhere; hence the interface
// is plain floats, no Eigen type (whose layout depends on compiler flags).
// Samples outside the image are clamped to the border (derivative 0 across it)
// and counted: the observation set stays frozen. With OutOfImage::kDrop they,
// and those behind the camera, have no residual, and are counted as lost.
// Derivatives: method, Sec. 7.2. Oracle: costs/photometric.h, in double.
#pragma once

#include <cstddef>
#include <cstdint>

#include "geometry/image_view.h"

namespace facet {

enum class LossKind { kSquared, kHuber, kCauchy, kTukey };  // robust_loss.h
enum class OutOfImage { kFreeze, kDrop };

// A keyframe as the kernel sees it. World coordinates are relative to the
// origin chosen by the caller: t = R * origin + t_original.
struct PhotoFrame {
  const float* image = nullptr;  // luma in [0, 1]
  int width = 0, height = 0;     // [px]
  ptrdiff_t stride = 0;          // elements
  float fx = 0, fy = 0, cx = 0, cy = 0;
  float r[9] = {};  // rotation of cam_from_world, row-major
  float t[3] = {};
  const float* warp = nullptr;  // 2 * columns * rows, or null: no warp
  int columns = 0, rows = 0;    // control vertices
  float inverse_cell_width = 0, inverse_cell_height = 0;  // [1/px]
  Sampling sampling = Sampling::kBilinear;
  const float* gradient_x =
      nullptr;  // Sampling::kScharr: of the image's stride
  const float* gradient_y = nullptr;
  LossKind loss = LossKind::kSquared;
  float loss_scale = 1;  // [intensity]
  OutOfImage out_of_image = OutOfImage::kFreeze;
};

// A texel as the kernel reads it: a point (q or p, by function) and its colour.
struct PhotoTexel {
  float x, y, z;
  float color;
};

// A texel of a patch of a plane: in-plane coordinates about the patch's centre
// and the distance n.(p - q) of the mesh point from the plane [m], and the
// colour that residuals are taken about.
struct PhotoPatchTexel {
  float e1, e2, s;
  float color;
};

// Sums over samples of a view, w = rho' (1 without a robust loss), gn as in
// problems/joint_rows.h.
struct PhotoViewSums {
  float squares;       // (w r)^2: the cost if all w are 1
  float g1, g2, gn;    // w r g
  float e1_g2, e1_gn;  // w r g, times the texel's coordinate
  float e2_g1, e2_gn;
  float s_g1, s_g2, s_gn;
};

// Where sample_rgb writes.
struct PhotoColors {
  float *u, *v;               // [px]
  float *red, *green, *blue;  // 0-255
};

struct PhotoCounts {
  size_t used = 0;     // all samples
  size_t clamped = 0;  // of them outside the image, moved to its border
  size_t behind = 0;   // of them behind (or nearer than 5 cm to) the camera
  size_t lost = 0;     // of them without residual (OutOfImage::kDrop)

  void operator+=(const PhotoCounts& other) {
    used += other.used;
    clamped += other.clamped;
    behind += other.behind;
    lost += other.lost;
  }
};

// A Gram matrix [J r]^T [J r]: upper triangle of (n+1) x (n+1), row-major, with
// the residual as last column.
inline constexpr int GramSize(int n) { return (n + 1) * (n + 1); }

// Fastest first. avx512_gather fetches the pixels of 16 observations by one
// instruction, on processors that do not take them one by one for it: those
// with FP16 arithmetic (Intel from Sapphire Rapids on).
inline constexpr const char* kPhotoKernelNames[] = {
    "avx512_gather", "avx512", "avx2", "baseline"};

struct PhotoKernel {
  const char* name;  // of kPhotoKernelNames

  // intensity[k] = I(F(pi(R q + t))) for the texels ids[0..n); NaN for those
  // that are dropped.
  void (*sample)(const PhotoFrame& frame,
                 const PhotoTexel* texels,
                 const uint32_t* ids,
                 size_t n,
                 float* intensity,
                 PhotoCounts* counts);

  // As `sample`, for plane points of one plane with in-plane axes e1, e2; also
  // the derivative of the intensity when the surface point moves along them:
  // g1 = grad_q I . e1, g2 = grad_q I . e2 [1/m]. The derivative along the
  // viewing ray is 0, which gives the third component.
  void (*sample_gradient)(const PhotoFrame& frame,
                          const float e1[3],
                          const float e2[3],
                          const PhotoTexel* texels,
                          const uint32_t* ids,
                          size_t n,
                          float* intensity,
                          float* g1,
                          float* g2,
                          PhotoCounts* counts);

  // As `sample`, but colours (0-255) of an image of 8-bit RGB pixels, rows
  // `row_bytes` apart, in place of frame.image; bilinear, frozen. Also the
  // pixel (u, v) = F(pi(R q + t)), which may lie outside.
  void (*sample_rgb)(const PhotoFrame& frame,
                     const uint8_t* rgb,
                     ptrdiff_t row_bytes,
                     const PhotoTexel* texels,
                     const uint32_t* ids,
                     size_t n,
                     const PhotoColors& out);

  // From samples of sample_gradient in one view of a patch, whose texels are
  // ids[k] - first. `weight` may be null. ray = (e1.d, e2.d, n.d) of the
  // viewing direction d to the patch's centre, not normalised.
  void (*view_sums)(const float* intensity,
                    const float* g1,
                    const float* g2,
                    const float* weight,
                    const PhotoPatchTexel* texels,
                    const uint32_t* ids,
                    uint32_t first,
                    size_t n,
                    const float ray[3],
                    PhotoViewSums* sums);

  // Sum rho(r^2) over texels given as plane points q in the warp cell whose
  // upper left vertex is in lattice column a and row b; frame.warp has just the
  // cell's four vertices f00, f10, f01, f11 (or is null: no warp), and the
  // cell's polynomial is used whatever u is. With `gram` also the Gram matrix
  // over (omega, upsilon | f00 f10 f01 f11): 14 columns if frame.warp is given
  // and `warp_columns`, else 6. gram is added to. With a robust loss its rows
  // are weighted with rho', but its last entry is the sum of rho: compressed
  // (costs/compressed_block.h) it has the exact cost and gradient.
  double (*frame_cell)(const PhotoFrame& frame,
                       float a,
                       float b,
                       const PhotoTexel* texels,
                       const uint32_t* ids,
                       size_t n,
                       bool warp_columns,
                       double* gram,
                       PhotoCounts* counts);

  // Sum rho(r^2) over texels given as mesh points p of one plane (n_x, n_y,
  // n_z, d) about the anchor c. With `gram` also the Gram matrix over the four
  // ambient plane parameters. gram is added to.
  double (*plane_segment)(const PhotoFrame& frame,
                          const float plane[4],
                          const float anchor[3],
                          const PhotoTexel* texels,
                          const uint32_t* ids,
                          size_t n,
                          double* gram,
                          PhotoCounts* counts);
};

// The fastest kernel this processor runs. The environment variable
// FACET_KERNEL asks for a particular one; a name that is unknown or not
// supported here gives a warning and the fastest.
const PhotoKernel& GetPhotoKernel();

// By name, one of kPhotoKernelNames; null if there is no such kernel or this
// processor does not run it well.
const PhotoKernel* FindPhotoKernel(const char* name);

}  // namespace facet
