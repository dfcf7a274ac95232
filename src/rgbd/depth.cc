// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "rgbd/depth.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

namespace facet {
namespace {

// What separates two surfaces when the depth image is warped.
constexpr float kJump = 0.05f;  // [m]
constexpr float kJumpRelative = 0.03f;
// A triangle owns pixel centres this far outside [px]: shared edges must not
// lose a pixel to rounding.
constexpr double kEdgeSlack = 1e-6;

// Do two neighbours belong to different surfaces? Missing = 0.
bool IsJump(float a, float b, float jump_m, float jump_rel) {
  const float near = std::min(a, b), far = std::max(a, b);
  if (near <= 0) return far > 0;
  return far - near > std::max(jump_m, jump_rel * near);
}

void Dilate(int radius_px, cv::Mat* mask) {
  if (radius_px <= 0) return;
  const int size = 2 * radius_px + 1;
  cv::dilate(
      *mask, *mask, cv::getStructuringElement(cv::MORPH_RECT, {size, size}));
}

// A depth pixel seen from the colour camera; inverse_z = 0: missing.
struct WarpedPixel {
  double u = 0, v = 0, inverse_z = 0;
};

// Draws into an inverse depth image; the largest 1/z is the nearest.
void DrawTriangle(const WarpedPixel& a,
                  const WarpedPixel& b,
                  const WarpedPixel& c,
                  cv::Mat* inverse_depth) {
  const double twice_area =
      (b.u - a.u) * (c.v - a.v) - (b.v - a.v) * (c.u - a.u);
  // Depth pixels run clockwise on the screen: a turned triangle shows its back
  // to the colour camera, which cannot see it.
  if (twice_area <= 0) return;
  const auto range =
      [](double p, double q, double r, int size, int* begin, int* end) {
        const double low = std::min({p, q, r}), high = std::max({p, q, r});
        if (high < 0 || low > size - 1) return false;
        *begin = static_cast<int>(std::ceil(std::max(low - kEdgeSlack, 0.0)));
        *end = static_cast<int>(
            std::floor(std::min(high + kEdgeSlack, size - 1.0)));
        return *begin <= *end;
      };
  int x0, x1, y0, y1;
  if (!range(a.u, b.u, c.u, inverse_depth->cols, &x0, &x1) ||
      !range(a.v, b.v, c.v, inverse_depth->rows, &y0, &y1)) {
    return;
  }
  const double scale = 1.0 / twice_area;
  const double slack = -kEdgeSlack * std::max(1.0, scale);
  const auto [far, near] = std::minmax({a.inverse_z, b.inverse_z, c.inverse_z});
  for (int y = y0; y <= y1; ++y) {
    float* row = inverse_depth->ptr<float>(y);
    for (int x = x0; x <= x1; ++x) {
      const double beta =
          ((x - a.u) * (c.v - a.v) - (y - a.v) * (c.u - a.u)) * scale;
      const double gamma =
          ((b.u - a.u) * (y - a.v) - (b.v - a.v) * (x - a.u)) * scale;
      const double alpha = 1 - beta - gamma;
      if (alpha < slack || beta < slack || gamma < slack) continue;
      const double inverse_z =
          alpha * a.inverse_z + beta * b.inverse_z + gamma * c.inverse_z;
      row[x] = std::max(row[x],
                        static_cast<float>(std::clamp(inverse_z, far, near)));
    }
  }
}

// Covers the nearest pixel where no surface of about the same depth does.
void DrawPoint(const WarpedPixel& p, cv::Mat* inverse_depth) {
  if (!(p.u > -0.5 && p.v > -0.5 && p.u < inverse_depth->cols - 0.5 &&
        p.v < inverse_depth->rows - 0.5)) {
    return;
  }
  float& there = inverse_depth->at<float>(static_cast<int>(p.v + 0.5),
                                          static_cast<int>(p.u + 0.5));
  const float here = static_cast<float>(p.inverse_z);
  if (there <= 0 ||
      (here > there && IsJump(1 / here, 1 / there, kJump, kJumpRelative))) {
    there = here;
  }
}

std::vector<WarpedPixel> WarpPixels(const cv::Mat& depth,
                                    const RgbdCalibration& calibration) {
  const Eigen::Matrix3d r = calibration.color_from_depth.RotationMatrix();
  const Eigen::Vector3d t = calibration.color_from_depth.translation;
  std::vector<WarpedPixel> pixels(depth.total());
  for (int y = 0; y < depth.rows; ++y) {
    for (int x = 0; x < depth.cols; ++x) {
      const float z = depth.at<float>(y, x);
      if (!(z > 0)) continue;
      const Eigen::Vector3d p = r * (z * calibration.depth.Unproject(x, y)) + t;
      if (p.z() <= 1e-6) continue;
      const Eigen::Vector2d u = calibration.color.Project(p);
      pixels[static_cast<size_t>(y) * depth.cols + x] = {
          u.x(), u.y(), 1 / p.z()};
    }
  }
  return pixels;
}

bool SameCamera(const RgbdCalibration& c) {
  const Pinhole &a = c.color, &b = c.depth;
  return a.fx == b.fx && a.fy == b.fy && a.cx == b.cx && a.cy == b.cy &&
         a.width == b.width && a.height == b.height &&
         c.color_from_depth.Matrix().isIdentity(1e-12);
}

void DrawSurfaces(const cv::Mat& depth,
                  const std::vector<WarpedPixel>& pixels,
                  cv::Mat* inverse_depth) {
  const auto joined = [](float p, float q, float r) {
    return p > 0 && q > 0 && r > 0 && !IsJump(p, q, kJump, kJumpRelative) &&
           !IsJump(q, r, kJump, kJumpRelative) &&
           !IsJump(p, r, kJump, kJumpRelative);
  };
  for (int y = 0; y + 1 < depth.rows; ++y) {
    const float* top = depth.ptr<float>(y);
    const float* low = depth.ptr<float>(y + 1);
    const WarpedPixel* top_pixels =
        &pixels[static_cast<size_t>(y) * depth.cols];
    const WarpedPixel* low_pixels = top_pixels + depth.cols;
    const auto draw =
        [&](const WarpedPixel& a, const WarpedPixel& b, const WarpedPixel& c) {
          if (a.inverse_z > 0 && b.inverse_z > 0 && c.inverse_z > 0) {
            DrawTriangle(a, b, c, inverse_depth);
          }
        };
    for (int x = 0; x + 1 < depth.cols; ++x) {
      const WarpedPixel &a = top_pixels[x], &b = top_pixels[x + 1];
      const WarpedPixel &c = low_pixels[x], &d = low_pixels[x + 1];
      const bool abd = joined(top[x], top[x + 1], low[x + 1]);
      const bool adc = joined(top[x], low[x + 1], low[x]);
      if (abd) draw(a, b, d);
      if (adc) draw(a, d, c);
      if (abd || adc) continue;
      // The other diagonal, where only three corners are on one surface.
      if (joined(top[x], top[x + 1], low[x])) draw(a, b, c);
      if (joined(top[x + 1], low[x + 1], low[x])) draw(b, d, c);
    }
  }
}

cv::Vec3b BilinearColor(const cv::Mat& image, double u, double v) {
  const int x = std::clamp(static_cast<int>(u), 0, image.cols - 2);
  const int y = std::clamp(static_cast<int>(v), 0, image.rows - 2);
  const double a = u - x, b = v - y;
  const cv::Vec3b* top = image.ptr<cv::Vec3b>(y) + x;
  const cv::Vec3b* low = image.ptr<cv::Vec3b>(y + 1) + x;
  cv::Vec3b color;
  for (int i = 0; i < 3; ++i) {
    color[i] = cv::saturate_cast<uint8_t>(
        (1 - b) * ((1 - a) * top[0][i] + a * top[1][i]) +
        b * ((1 - a) * low[0][i] + a * low[1][i]));
  }
  return color;
}

}  // namespace

cv::Mat DepthEdgeMask(const cv::Mat& depth,
                      double jump_m,
                      double jump_rel,
                      int dilate_px) {
  cv::Mat edges = cv::Mat::zeros(depth.size(), CV_8U);
  const float jump = static_cast<float>(jump_m);
  const float relative = static_cast<float>(jump_rel);
  for (int y = 0; y < depth.rows; ++y) {
    for (int x = 0; x < depth.cols; ++x) {
      const float z = depth.at<float>(y, x);
      if (x + 1 < depth.cols &&
          IsJump(z, depth.at<float>(y, x + 1), jump, relative)) {
        edges.at<uint8_t>(y, x) = edges.at<uint8_t>(y, x + 1) = 255;
      }
      if (y + 1 < depth.rows &&
          IsJump(z, depth.at<float>(y + 1, x), jump, relative)) {
        edges.at<uint8_t>(y, x) = edges.at<uint8_t>(y + 1, x) = 255;
      }
    }
  }
  Dilate(dilate_px, &edges);
  return edges;
}

cv::Mat SurfaceEdgeMask(const cv::Mat& depth,
                        double jump_m,
                        double jump_rel,
                        int dilate_px) {
  cv::Mat inverse(depth.size(), CV_32F);
  for (int y = 0; y < depth.rows; ++y) {
    for (int x = 0; x < depth.cols; ++x) {
      const float z = depth.at<float>(y, x);
      inverse.at<float>(y, x) = z > 0 ? 1 / z : 0;
    }
  }
  cv::Mat edges = cv::Mat::zeros(depth.size(), CV_8U);
  const auto mark = [&](int y, int x, int dy, int dx) {
    const float* w = &inverse.at<float>(y, x);
    const ptrdiff_t next = dy * static_cast<ptrdiff_t>(inverse.step1()) + dx;
    const float near = std::max(w[0], w[next]);
    if (near == 0) return;
    const float before = 1.5f * w[0] - 0.5f * w[-next];
    const float after = 1.5f * w[next] - 0.5f * w[2 * next];
    // |dz| = z^2 |d(1/z)| at the nearer surface.
    const float z = 1 / near;
    const float jump = static_cast<float>(std::max(jump_m, jump_rel * z));
    if (std::abs(before - after) * z * z > jump) {
      edges.at<uint8_t>(y, x) = edges.at<uint8_t>(y + dy, x + dx) = 255;
    }
  };
  for (int y = 0; y < depth.rows; ++y) {
    for (int x = 0; x < depth.cols; ++x) {
      if (x >= 1 && x + 2 < depth.cols) mark(y, x, 0, 1);
      if (y >= 1 && y + 2 < depth.rows) mark(y, x, 1, 0);
    }
  }
  Dilate(dilate_px, &edges);
  return edges;
}

cv::Mat WarpDepthToColor(const cv::Mat& depth,
                         const RgbdCalibration& calibration) {
  if (SameCamera(calibration)) return depth.clone();
  cv::Mat inverse_depth =
      cv::Mat::zeros(calibration.color.height, calibration.color.width, CV_32F);
  const std::vector<WarpedPixel> pixels = WarpPixels(depth, calibration);
  DrawSurfaces(depth, pixels, &inverse_depth);
  for (const WarpedPixel& pixel : pixels) {
    if (pixel.inverse_z > 0) DrawPoint(pixel, &inverse_depth);
  }
  for (int y = 0; y < inverse_depth.rows; ++y) {
    float* row = inverse_depth.ptr<float>(y);
    for (int x = 0; x < inverse_depth.cols; ++x) {
      if (row[x] > 0) row[x] = 1 / row[x];
    }
  }
  return inverse_depth;
}

RegisteredColor RegisterColorToDepth(const cv::Mat& color,
                                     const cv::Mat& depth,
                                     const RgbdCalibration& calibration) {
  const cv::Mat surface = WarpDepthToColor(depth, calibration);
  const std::vector<WarpedPixel> pixels = WarpPixels(depth, calibration);
  RegisteredColor result;
  result.color = cv::Mat::zeros(depth.size(), CV_8UC3);
  result.seen = cv::Mat::zeros(depth.size(), CV_8U);
  for (int y = 0; y < depth.rows; ++y) {
    for (int x = 0; x < depth.cols; ++x) {
      const WarpedPixel& p = pixels[static_cast<size_t>(y) * depth.cols + x];
      if (p.inverse_z <= 0 || !calibration.color.Contains({p.u, p.v})) continue;
      const float front = surface.at<float>(static_cast<int>(p.v + 0.5),
                                            static_cast<int>(p.u + 0.5));
      const float z = static_cast<float>(1 / p.inverse_z);
      if (front > 0 && z > front && IsJump(front, z, kJump, kJumpRelative)) {
        continue;
      }
      result.color.at<cv::Vec3b>(y, x) = BilinearColor(color, p.u, p.v);
      result.seen.at<uint8_t>(y, x) = 255;
    }
  }
  return result;
}

}  // namespace facet
