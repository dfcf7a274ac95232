// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "eval/photometric_metrics.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "util/parallel_for.h"

namespace facet {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kTrimRms = 2.5;

double PsnrFromMse(double mse) {
  if (mse <= 0) return kMaxPsnr;
  return std::min(kMaxPsnr, 10 * std::log10(255.0 * 255.0 / mse));
}

// Sums of one channel of model x and photo y over accepted pixels.
struct LineSums {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  void Add(double a, double b) {
    n += 1;
    x += a;
    y += b;
    xx += a * a;
    xy += a * b;
  }
};

// Calls body(x pixel, y pixel) for all pixels of the mask, row by row.
template <typename F>
void ForEachPixel(const cv::Mat& mask, const F& body) {
  for (int i = 0; i < mask.rows; ++i) {
    const uchar* row = mask.ptr<uchar>(i);
    for (int j = 0; j < mask.cols; ++j) {
      if (row[j] != 0) body(i, j);
    }
  }
}

void SolveLine(const LineSums& s, double* gain, double* bias) {
  if (s.n == 0) return;
  const double variance = s.xx - s.x * s.x / s.n;
  *gain = variance > 1e-6 * s.n ? (s.xy - s.x * s.y / s.n) / variance : 1.0;
  *bias = (s.y - *gain * s.x) / s.n;
}

// Window means inside the mask: blur(mask * image) / blur(mask).
class MaskedWindow {
 public:
  explicit MaskedWindow(const cv::Mat& mask) {
    mask.convertTo(mask_, CV_32F, 1.0 / 255);
    weight_ = Blur(mask_);
    // Outside the window's reach the weight is 0; those pixels are never read.
    weight_ = cv::max(weight_, 1e-6f);
  }
  cv::Mat Mean(const cv::Mat& image) const {
    return Blur(image.mul(mask_)) / weight_;
  }

 private:
  static cv::Mat Blur(const cv::Mat& image) {
    cv::Mat blurred;
    cv::GaussianBlur(
        image, blurred, cv::Size(11, 11), 1.5, 1.5, cv::BORDER_CONSTANT);
    return blurred;
  }
  cv::Mat mask_, weight_;
};

double Median(std::vector<float>* values) {
  if (values->empty()) return kNan;
  const auto middle = values->begin() + values->size() / 2;
  std::nth_element(values->begin(), middle, values->end());
  return *middle;
}

// The model with the photo's mean colour where it is not hit.
cv::Mat FillHoles(const cv::Mat& color,
                  const cv::Mat& hit,
                  const cv::Scalar& mean) {
  cv::Mat filled = color.clone();
  filled.setTo(mean, hit == 0);
  return filled;
}

}  // namespace

ModelView RenderView(const TexturedMesh& model,
                     const RayScene& scene,
                     const Pinhole& camera,
                     const Pose& cam_from_world) {
  const DepthRender render = RenderDepth(scene, camera, cam_from_world);
  ModelView view;
  view.color = cv::Mat::zeros(camera.height, camera.width, CV_32FC3);
  view.depth = cv::Mat::zeros(camera.height, camera.width, CV_32F);
  ParallelFor(
      0,
      camera.height,
      [&](size_t i) {
        const size_t begin = i * camera.width;
        cv::Vec3f* color = view.color.ptr<cv::Vec3f>(static_cast<int>(i));
        float* depth = view.depth.ptr<float>(static_cast<int>(i));
        for (int j = 0; j < camera.width; ++j) {
          const size_t p = begin + j;
          if (render.face[p] < 0) continue;
          depth[j] = render.depth[p];
          const Eigen::Vector3f c =
              ColorAt(model, render.face[p], render.u[p], render.v[p]);
          color[j] = cv::Vec3f(c.x(), c.y(), c.z());
        }
      },
      16);
  return view;
}

cv::Mat LumaFromColor(const cv::Mat& color) {
  cv::Mat luma;
  cv::transform(color, luma, cv::Matx13f(0.299f, 0.587f, 0.114f));
  return luma;
}

cv::Mat AgreementMask(const cv::Mat& model_depth,
                      const cv::Mat& sensor_depth,
                      double max_difference_m) {
  cv::Mat difference;
  cv::absdiff(model_depth, sensor_depth, difference);
  return (model_depth > 0) & (sensor_depth > 0) &
         (difference < max_difference_m);
}

AffineColor FitAffineColor(const cv::Mat& model,
                           const cv::Mat& photo,
                           const cv::Mat& mask) {
  AffineColor fit;
  for (int c = 0; c < 3; ++c) {
    double limit = std::numeric_limits<double>::infinity();
    for (int round = 0; round < 2; ++round) {
      const double gain = fit.gain[c], bias = fit.bias[c];
      LineSums sums;
      ForEachPixel(mask, [&](int i, int j) {
        const double x = model.at<cv::Vec3f>(i, j)[c];
        const double y = photo.at<cv::Vec3f>(i, j)[c];
        if (std::abs(gain * x + bias - y) <= limit) sums.Add(x, y);
      });
      SolveLine(sums, &fit.gain[c], &fit.bias[c]);
      double squares = 0;
      ForEachPixel(mask, [&](int i, int j) {
        const double r = fit.gain[c] * model.at<cv::Vec3f>(i, j)[c] +
                         fit.bias[c] - photo.at<cv::Vec3f>(i, j)[c];
        squares += r * r;
      });
      // The constant keeps exact fits from trimming by rounding noise.
      limit = kTrimRms * std::sqrt(squares / std::max(1.0, sums.n)) + 1e-3;
    }
  }
  return fit;
}

cv::Mat ApplyAffineColor(const AffineColor& affine, const cv::Mat& model) {
  cv::Mat result(model.size(), CV_32FC3);
  for (int i = 0; i < model.rows; ++i) {
    const cv::Vec3f* from = model.ptr<cv::Vec3f>(i);
    cv::Vec3f* to = result.ptr<cv::Vec3f>(i);
    for (int j = 0; j < model.cols; ++j) {
      for (int c = 0; c < 3; ++c) {
        to[j][c] = static_cast<float>(std::clamp(
            affine.gain[c] * from[j][c] + affine.bias[c], 0.0, 255.0));
      }
    }
  }
  return result;
}

double MaskedPsnr(const cv::Mat& a, const cv::Mat& b, const cv::Mat& mask) {
  double squares = 0;
  size_t count = 0;
  ForEachPixel(mask, [&](int i, int j) {
    const cv::Vec3f d = a.at<cv::Vec3f>(i, j) - b.at<cv::Vec3f>(i, j);
    squares += d.dot(d);
    count += 3;
  });
  return count == 0 ? kNan : PsnrFromMse(squares / count);
}

double MaskedSsim(const cv::Mat& luma_a,
                  const cv::Mat& luma_b,
                  const cv::Mat& mask) {
  const MaskedWindow window(mask);
  const cv::Mat mean_a = window.Mean(luma_a), mean_b = window.Mean(luma_b);
  const cv::Mat var_a = window.Mean(luma_a.mul(luma_a)) - mean_a.mul(mean_a);
  const cv::Mat var_b = window.Mean(luma_b.mul(luma_b)) - mean_b.mul(mean_b);
  const cv::Mat cov = window.Mean(luma_a.mul(luma_b)) - mean_a.mul(mean_b);
  const double c1 = 0.01 * 255 * 0.01 * 255, c2 = 0.03 * 255 * 0.03 * 255;
  double sum = 0;
  size_t count = 0;
  ForEachPixel(mask, [&](int i, int j) {
    const double ma = mean_a.at<float>(i, j), mb = mean_b.at<float>(i, j);
    const double va = var_a.at<float>(i, j), vb = var_b.at<float>(i, j);
    sum += (2 * ma * mb + c1) * (2 * cov.at<float>(i, j) + c2) /
           ((ma * ma + mb * mb + c1) * (va + vb + c2));
    ++count;
  });
  return count == 0 ? kNan : sum / count;
}

GradientAgreement CompareGradients(const cv::Mat& model_luma,
                                   const cv::Mat& photo_luma,
                                   const cv::Mat& mask) {
  cv::Mat inner, model_x, model_y, photo_x, photo_y;
  // Beyond the border nothing is known: it erodes as well.
  cv::erode(mask,
            inner,
            cv::Mat::ones(5, 5, CV_8U),
            cv::Point(-1, -1),
            1,
            cv::BORDER_CONSTANT,
            cv::Scalar(0));
  cv::Sobel(model_luma, model_x, CV_32F, 1, 0, 3, 1.0 / 8);
  cv::Sobel(model_luma, model_y, CV_32F, 0, 1, 3, 1.0 / 8);
  cv::Sobel(photo_luma, photo_x, CV_32F, 1, 0, 3, 1.0 / 8);
  cv::Sobel(photo_luma, photo_y, CV_32F, 0, 1, 3, 1.0 / 8);
  double mm = 0, pp = 0, mp = 0;
  ForEachPixel(inner, [&](int i, int j) {
    const double mx = model_x.at<float>(i, j), my = model_y.at<float>(i, j);
    const double px = photo_x.at<float>(i, j), py = photo_y.at<float>(i, j);
    mm += mx * mx + my * my;
    pp += px * px + py * py;
    mp += mx * px + my * py;
  });
  GradientAgreement result;
  result.ncc = mm > 0 && pp > 0 ? mp / std::sqrt(mm * pp) : kNan;
  result.energy = pp > 0 ? mm / pp : kNan;
  return result;
}

ViewMetrics CompareView(const ModelView& view,
                        const cv::Mat& photo,
                        const cv::Mat& sensor_depth,
                        double max_depth_difference_m) {
  cv::Mat photo_color;
  photo.convertTo(photo_color, CV_32F);
  const cv::Mat photo_luma = LumaFromColor(photo_color);
  const cv::Mat model_luma = LumaFromColor(view.color);
  const cv::Mat with_depth = sensor_depth > 0, hit = view.depth > 0;
  const cv::Mat both = with_depth & hit;
  const cv::Mat mask =
      AgreementMask(view.depth, sensor_depth, max_depth_difference_m);
  ViewMetrics m;
  m.depth_pixels = cv::countNonZero(with_depth);
  m.mask_pixels = cv::countNonZero(mask);
  const double pixels = m.depth_pixels == 0 ? kNan : m.depth_pixels;
  m.coverage = cv::countNonZero(both) / pixels;
  m.agreement = m.mask_pixels / pixels;

  const AffineColor affine = FitAffineColor(view.color, photo_color, mask);
  const cv::Mat corrected = ApplyAffineColor(affine, view.color);
  const cv::Scalar mean = cv::mean(photo_color);
  m.psnr = MaskedPsnr(view.color, photo_color, mask);
  m.psnr_affine = MaskedPsnr(corrected, photo_color, mask);
  m.psnr_strict =
      MaskedPsnr(FillHoles(view.color, hit, mean), photo_color, with_depth);
  m.psnr_strict_affine =
      MaskedPsnr(FillHoles(corrected, hit, mean), photo_color, with_depth);
  m.ssim = MaskedSsim(model_luma, photo_luma, mask);
  m.ssim_affine = MaskedSsim(LumaFromColor(corrected), photo_luma, mask);
  const GradientAgreement gradients =
      CompareGradients(model_luma, photo_luma, mask);
  m.gradient_ncc = gradients.ncc;
  m.gradient_energy = gradients.energy;

  std::vector<float> errors;
  ForEachPixel(both, [&](int i, int j) {
    errors.push_back(
        std::abs(view.depth.at<float>(i, j) - sensor_depth.at<float>(i, j)));
  });
  double sum = 0;
  for (const float e : errors) sum += e < max_depth_difference_m ? e : 0;
  m.depth_error_mean = m.mask_pixels > 0 ? sum / m.mask_pixels : kNan;
  m.depth_error_median = Median(&errors);
  return m;
}

}  // namespace facet
