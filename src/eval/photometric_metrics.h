// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// How well a picture of the model agrees with a photo (method, Sec. 11.2).
//
// The model is rendered in the colour camera, one ray a pixel centre, with
// exact bilinear texture lookup. Colours are RGB 0-255; luma is 0.299 R + 0.587
// G + 0.114 B, 0-255 too. The mask of the metrics holds the pixels where the
// model is hit and its depth differs from the sensor's (warped into the colour
// camera) by less than a threshold.
//
//   PSNR      10 log10(255^2 / MSE) over the mask and the three channels, at
//             most kMaxPsnr (identical pictures have no finite one)
//   affine    the same after a gain and bias a channel, fitted by least squares
//             to the mask, once more without residuals above 2.5 rms
//   strict    all pixels with sensor depth; where the model is not hit it takes
//             the mean colour of the photo
//   SSIM      luma, Gaussian window 11 x 11 with sigma 1.5, all moments
//             normalised by the window's weight inside the mask; mean over it
//   gradients Sobel / 8 of luma on the mask eroded by 5 x 5, model r, photo i:
//             NCC = sum g_r.g_i / sqrt(sum |g_r|^2 sum |g_i|^2)
//             energy = sum |g_r|^2 / sum |g_i|^2
//   coverage  share of the pixels with sensor depth where the model is hit
#pragma once

#include <array>
#include <opencv2/core.hpp>

#include "geometry/pinhole.h"
#include "geometry/pose.h"
#include "render/ray_scene.h"
#include "texture/textured_mesh.h"

namespace facet {

inline constexpr double kMaxPsnr = 100;  // [dB]

struct ModelView {
  cv::Mat color;  // CV_32FC3, RGB 0-255, 0 where nothing is hit
  cv::Mat depth;  // CV_32F, z [m], 0 = nothing hit
};

// The model must have colours (HasColor of texture/model_io.h); `scene` is
// built from model.mesh.
ModelView RenderView(const TexturedMesh& model,
                     const RayScene& scene,
                     const Pinhole& camera,
                     const Pose& cam_from_world);

// CV_32F 0-255 of a CV_32FC3 RGB picture.
cv::Mat LumaFromColor(const cv::Mat& color);

// CV_8U 255 where both depths are known and differ by less than
// `max_difference_m`.
cv::Mat AgreementMask(const cv::Mat& model_depth,
                      const cv::Mat& sensor_depth,
                      double max_difference_m);

// photo = gain * model + bias, a channel.
struct AffineColor {
  std::array<double, 3> gain{1, 1, 1}, bias{0, 0, 0};
};
// The fit described above. A channel that is constant in the model keeps
// gain 1.
AffineColor FitAffineColor(const cv::Mat& model,
                           const cv::Mat& photo,
                           const cv::Mat& mask);
// Applied and clamped to 0-255.
cv::Mat ApplyAffineColor(const AffineColor& affine, const cv::Mat& model);

// All pictures CV_32FC3 or luma CV_32F of one size; masks CV_8U, 0 = outside.
// NaN for empty masks.
double MaskedPsnr(const cv::Mat& a, const cv::Mat& b, const cv::Mat& mask);
double MaskedSsim(const cv::Mat& luma_a,
                  const cv::Mat& luma_b,
                  const cv::Mat& mask);

struct GradientAgreement {
  double ncc = 0, energy = 0;  // NaN where the denominators vanish
};
// Erodes the mask itself.
GradientAgreement CompareGradients(const cv::Mat& model_luma,
                                   const cv::Mat& photo_luma,
                                   const cv::Mat& mask);

// All of the above at one pose.
struct ViewMetrics {
  size_t depth_pixels = 0;  // with sensor depth
  size_t mask_pixels = 0;
  double coverage = 0;
  double agreement = 0;  // mask pixels / depth pixels
  double psnr = 0, psnr_affine = 0, psnr_strict = 0;
  double psnr_strict_affine = 0;  // strict after the affine fit of the mask
  double ssim = 0, ssim_affine = 0;
  double gradient_ncc = 0, gradient_energy = 0;
  // |z - sensor depth| where the model is hit [m]: the mean over the mask, the
  // median without the threshold.
  double depth_error_mean = 0, depth_error_median = 0;
};

// `photo` is CV_8UC3 RGB, `sensor_depth` CV_32F [m], both of the view's size.
ViewMetrics CompareView(const ModelView& view,
                        const cv::Mat& photo,
                        const cv::Mat& sensor_depth,
                        double max_depth_difference_m);

}  // namespace facet
