// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "texture/visibility.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "render/depth_raster.h"
#include "rgbd/depth.h"

namespace facet {
namespace {

using Eigen::Vector3f;

constexpr float kNothing = 1e9f;  // z of pixels where no mesh is
// The mild verdict: 85 degrees, and free space before the point [m].
constexpr float kMildCos = 0.087f;
constexpr float kFreeSpace = 0.1f;

}  // namespace

Ball BallAround(const Vector3f* points, size_t count) {
  Ball ball;
  if (count == 0) return ball;
  Vector3f low = points[0], high = points[0];
  for (size_t i = 1; i < count; ++i) {
    low = low.cwiseMin(points[i]);
    high = high.cwiseMax(points[i]);
  }
  ball.center = 0.5f * (low + high);
  float squared = 0;
  for (size_t i = 0; i < count; ++i) {
    squared = std::max(squared, (points[i] - ball.center).squaredNorm());
  }
  ball.radius = std::sqrt(squared) * 1.0001f + 1e-5f;
  return ball;
}

FrameView::FrameView(const RgbdCalibration& calibration,
                     const Pose& color_cam_from_world,
                     const cv::Mat& depth,
                     const RayScene& scene,
                     const VisibilityOptions& options)
    : scene_(scene),
      options_(options),
      color_px_(calibration.color),
      depth_px_(calibration.depth),
      rotation_(color_cam_from_world.RotationMatrix().cast<float>()),
      translation_(color_cam_from_world.translation.cast<float>()),
      center_(color_cam_from_world.CenterInSource().cast<float>()),
      min_cos_(
          static_cast<float>(std::cos(options.max_angle_deg * M_PI / 180.0))),
      range_{static_cast<float>(options.min_depth_m),
             static_cast<float>(options.max_depth_m)},
      margin_(static_cast<float>(options.image_margin_px)),
      depth_(depth) {
  const Pinhole& color = calibration.color;
  const Pose depth_cam_from_world =
      calibration.color_from_depth.Inverse() * color_cam_from_world;
  depth_rotation_ = depth_cam_from_world.RotationMatrix().cast<float>();
  depth_translation_ = depth_cam_from_world.translation.cast<float>();
  if (options.test_depth_edges && !depth.empty()) {
    edges_ = DepthEdgeMask(depth,
                           options.depth_edge_jump_m,
                           options.depth_edge_jump_rel,
                           options.depth_edge_dilate_px);
  }
  if (options.test_occlusion || options.test_mesh_edges) {
    std::vector<float> depth_of_mesh =
        RasterizeDepth(scene, color, color_cam_from_world);
    const cv::Mat z(color.height, color.width, CV_32F, depth_of_mesh.data());
    if (options.test_mesh_edges) {
      mesh_edges_ = SurfaceEdgeMask(z,
                                    options.mesh_edge_jump_m,
                                    options.mesh_edge_jump_rel,
                                    options.mesh_edge_dilate_px);
    }
    for (float& pixel : depth_of_mesh) pixel = pixel > 0 ? pixel : kNothing;
    cv::erode(z, nearest_, cv::Mat::ones(3, 3, CV_8U));
    cv::dilate(z, farthest_, cv::Mat::ones(3, 3, CV_8U));
  }
  const double margin = options.image_margin_px;
  const auto left = color.Unproject(margin, margin);
  const auto right =
      color.Unproject(color.width - 1 - margin, color.height - 1 - margin);
  sides_[0] = Vector3f(1, 0, static_cast<float>(-left.x())).normalized();
  sides_[1] = Vector3f(0, 1, static_cast<float>(-left.y())).normalized();
  sides_[2] = Vector3f(-1, 0, static_cast<float>(right.x())).normalized();
  sides_[3] = Vector3f(0, -1, static_cast<float>(right.y())).normalized();
}

Sight FrameView::TestBall(const Ball& ball) const {
  const Vector3f y = rotation_ * ball.center + translation_;
  const float low = range_[0], high = range_[1];
  if (y.z() + ball.radius < low || y.z() - ball.radius > high) {
    return Sight::kBehindOrFar;
  }
  // Some points may be too near or far: those have to be told apart.
  if (y.z() - ball.radius < low || y.z() + ball.radius > high) {
    return Sight::kVisible;
  }
  for (const Vector3f& side : sides_) {
    if (side.dot(y) < -ball.radius) return Sight::kOutsideImage;
  }
  return Sight::kVisible;
}

bool FrameView::IsInRangeAndImage(const Vector3f& q, Sight* refusal) const {
  const Vector3f y = rotation_ * q + translation_;
  if (!(y.z() > range_[0]) || y.z() > range_[1]) {
    *refusal = Sight::kBehindOrFar;
    return false;
  }
  *refusal = Sight::kOutsideImage;
  return color_px_.Contains(color_px_.Project(y), margin_);
}

Sight FrameView::Test(const Vector3f& p,
                      const Vector3f& q,
                      const Vector3f& normal,
                      bool* may_see) const {
  if (may_see) *may_see = false;
  Sight sight = Sight::kVisible;
  if (!IsInRangeAndImage(q, &sight)) return sight;
  const Vector3f view = center_ - q;
  const float along = normal.dot(view);
  const auto flatter_than = [&](float cosine) {
    return along <= 0 || along * along < cosine * cosine * view.squaredNorm();
  };
  bool mild = may_see && !flatter_than(kMildCos);
  const bool grazing = options_.test_angle && flatter_than(min_cos_);
  if (grazing && !mild) return Sight::kGrazing;
  const DepthReading reading = ReadDepth(q);
  mild &= !(reading.measured > 0 && reading.measured < reading.z - kFreeSpace);
  sight = grazing ? Sight::kGrazing : TestSensorDepth(reading);
  if (sight == Sight::kVisible && IsAtMeshEdge(p)) sight = Sight::kMeshEdge;
  if (sight != Sight::kVisible && !mild) return sight;
  const bool occluded = options_.test_occlusion && IsOccluded(p);
  if (may_see) *may_see = !occluded;
  return sight == Sight::kVisible && occluded ? Sight::kOccluded : sight;
}

FrameView::DepthReading FrameView::ReadDepth(const Vector3f& q) const {
  DepthReading reading;
  if (depth_.empty()) return reading;
  const Vector3f y = depth_rotation_ * q + depth_translation_;
  reading.z = y.z();
  if (!(y.z() > 0)) return reading;
  const Eigen::Vector2f u = depth_px_.Project(y);
  // Compared as numbers: far outside, an int would overflow.
  if (!depth_px_.Contains(u, -0.49f)) return reading;
  reading.column = static_cast<int>(u.x() + 0.5f);
  reading.row = static_cast<int>(u.y() + 0.5f);
  reading.measured = depth_.ptr<float>(reading.row)[reading.column];
  return reading;
}

Sight FrameView::TestSensorDepth(const DepthReading& reading) const {
  const bool missing = !(reading.measured > 0);
  if (options_.test_sensor_depth && missing && !options_.allow_missing_depth) {
    return Sight::kDepthMissing;
  }
  if (options_.test_depth_edges && reading.column >= 0 && !edges_.empty() &&
      edges_.ptr<uint8_t>(reading.row)[reading.column]) {
    return Sight::kDepthEdge;
  }
  if (options_.test_sensor_depth && !missing) {
    const double tolerance = std::max(options_.min_depth_tolerance_m,
                                      3 * DepthSigma(reading.z) + 0.02);
    if (std::abs(reading.measured - reading.z) > tolerance) {
      return Sight::kDepthDisagrees;
    }
  }
  return Sight::kVisible;
}

bool FrameView::IsAtMeshEdge(const Vector3f& p) const {
  if (mesh_edges_.empty()) return false;
  const Vector3f y = rotation_ * p + translation_;
  if (!(y.z() > 1e-3f)) return false;
  const Eigen::Vector2f u = color_px_.Project(y);
  if (!color_px_.Contains(u, -0.49f)) return false;
  return mesh_edges_.ptr<uint8_t>(static_cast<int>(
             u.y() + 0.5f))[static_cast<int>(u.x() + 0.5f)] != 0;
}

bool FrameView::IsOccluded(const Vector3f& p) const {
  const Vector3f y = rotation_ * p + translation_;
  if (!(y.z() > 1e-3f)) return true;
  const float limit =
      y.z() - static_cast<float>(options_.occlusion_tolerance_m);
  const Eigen::Vector2f u = color_px_.Project(y);
  if (color_px_.Contains(u, -0.49f)) {
    const int col = static_cast<int>(u.x() + 0.5f);
    const int row = static_cast<int>(u.y() + 0.5f);
    if (nearest_.ptr<float>(row)[col] >= limit) return false;
    if (farthest_.ptr<float>(row)[col] < limit) return true;
  }
  // z grows linearly along the ray: hits with z < limit have t < limit / z.
  const Eigen::Vector3d origin = center_.cast<double>();
  const double t_max = limit / y.z();
  return t_max > 0 &&
         scene_.Occluded(origin, p.cast<double>() - origin, 0, t_max);
}

}  // namespace facet
