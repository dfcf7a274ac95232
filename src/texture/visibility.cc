// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "texture/visibility.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "render/depth_raster.h"
#include "rgbd/depth.h"

namespace facet {
namespace {

using Eigen::Vector3f;

constexpr float kNothing = 1e9f;  // z of pixels where no mesh is
constexpr float kMinZ = 1e-3f;    // nearer points have no pixel [m]
// The mild verdict: 85 degrees, and free space before the point [m].
constexpr float kMildCos = 0.087f;
constexpr float kFreeSpace = 0.1f;

// Also of 0: to -0.
void NegateWhere(const cv::Mat& mask, cv::Mat* image) {
  for (int row = 0; row < image->rows; ++row) {
    const uint8_t* negate = mask.ptr<uint8_t>(row);
    float* pixel = image->ptr<float>(row);
    for (int column = 0; column < image->cols; ++column) {
      pixel[column] = negate[column] ? -pixel[column] : pixel[column];
    }
  }
}

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
      color_from_world_(color_cam_from_world),
      depth_from_world_(calibration.color_from_depth.Inverse() *
                        color_cam_from_world),
      center_(color_cam_from_world.CenterInSource().cast<float>()),
      min_cos_(
          static_cast<float>(std::cos(options.max_angle_deg * M_PI / 180.0))),
      range_{static_cast<float>(options.min_depth_m),
             static_cast<float>(options.max_depth_m)},
      margin_(static_cast<float>(options.image_margin_px)) {
  const Pinhole& color = calibration.color;
  depth_ = depth.clone();
  if (options.test_depth_edges && !depth.empty()) {
    NegateWhere(DepthEdgeMask(depth,
                              options.depth_edge_jump_m,
                              options.depth_edge_jump_rel,
                              options.depth_edge_dilate_px),
                &depth_);
  }
  if (options.test_occlusion || options.test_mesh_edges) {
    ReadMesh(scene, color, color_cam_from_world);
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

void FrameView::ReadMesh(const RayScene& scene,
                         const Pinhole& color,
                         const Pose& color_cam_from_world) {
  std::vector<float> depth_of_mesh =
      RasterizeDepth(scene, color, color_cam_from_world);
  const cv::Mat z(color.height, color.width, CV_32F, depth_of_mesh.data());
  cv::Mat edges;
  if (options_.test_mesh_edges) {
    edges = SurfaceEdgeMask(z,
                            options_.mesh_edge_jump_m,
                            options_.mesh_edge_jump_rel,
                            options_.mesh_edge_dilate_px);
  }
  for (float& pixel : depth_of_mesh) pixel = pixel > 0 ? pixel : kNothing;
  cv::Mat nearest_and_farthest[2];
  cv::erode(z, nearest_and_farthest[0], cv::Mat::ones(3, 3, CV_8U));
  cv::dilate(z, nearest_and_farthest[1], cv::Mat::ones(3, 3, CV_8U));
  if (!edges.empty()) NegateWhere(edges, &nearest_and_farthest[0]);
  cv::merge(nearest_and_farthest, 2, surface_);
}

Sight FrameView::TestBall(const Ball& ball) const {
  const Vector3f& c = ball.center;
  const Vector3f y(color_from_world_.X(c.x(), c.y(), c.z()),
                   color_from_world_.Y(c.x(), c.y(), c.z()),
                   color_from_world_.Z(c.x(), c.y(), c.z()));
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

// What is known of the points of a batch so far.
struct FrameView::Lanes {
  static constexpr int kSize = SightBatch::kCapacity;

  int sight[kSize];  // the first test that failed, as a number
  int mild[kSize];   // nothing speaks against the milder verdict
  // The depth image: -1 = outside; measured depth, 0 = missing; z of the point.
  int depth_pixel[kSize];
  float measured[kSize], depth_z[kSize];
  int at_depth_edge[kSize];
  // The rendered mesh around the pixel of a point: -1 = outside.
  int surface_pixel[kSize];
  float nearest[kSize], farthest[kSize], surface_z[kSize];
  int at_mesh_edge[kSize];
};

// Range, image and angle. Returns whether any point is left.
bool FrameView::TestPlace(const SightBatch& batch, Lanes* lanes) const {
  const FloatPose pose = color_from_world_;
  const PixelFinder px = color_px_;
  const float low = range_[0], high = range_[1], margin = margin_;
  const float cx = center_.x(), cy = center_.y(), cz = center_.z();
  const float nx = batch.normal.x(), ny = batch.normal.y();
  const float nz = batch.normal.z();
  const float min_squared = options_.test_angle ? min_cos_ * min_cos_ : 0.0f;
  const float min_along =
      options_.test_angle ? 0.0f : -std::numeric_limits<float>::max();
  int left = 0;
  for (int i = 0; i < batch.size; ++i) {
    const float qx = batch.q[0][i], qy = batch.q[1][i], qz = batch.q[2][i];
    const float z = pose.Z(qx, qy, qz), inverse_z = 1 / z;
    const float u = px.U(pose.X(qx, qy, qz), inverse_z);
    const float v = px.V(pose.Y(qx, qy, qz), inverse_z);
    const float vx = cx - qx, vy = cy - qy, vz = cz - qz;
    const float along = nx * vx + ny * vy + nz * vz;
    const float squared = vx * vx + vy * vy + vz * vz;
    const bool in_range = (z > low) & (z <= high);
    const bool in_image = px.Contains(u, v, margin);
    const bool grazing =
        (along <= min_along) | (along * along < min_squared * squared);
    const bool flat =
        (along <= 0) | (along * along < kMildCos * kMildCos * squared);
    int sight = static_cast<int>(Sight::kVisible);
    sight = grazing ? static_cast<int>(Sight::kGrazing) : sight;
    sight = in_image ? sight : static_cast<int>(Sight::kOutsideImage);
    sight = in_range ? sight : static_cast<int>(Sight::kBehindOrFar);
    const int mild = in_range & in_image & !flat;
    lanes->sight[i] = sight;
    lanes->mild[i] = mild;
    left |= mild | (sight == static_cast<int>(Sight::kVisible));
  }
  return left != 0;
}

void FrameView::FindPixels(const float* const points[3],
                           int size,
                           const FloatPose& pose,
                           const PixelFinder& px,
                           const cv::Mat& image,
                           float min_z,
                           float* z,
                           int* pixel) {
  const int row_step = static_cast<int>(image.step1());
  const int column_step = image.channels();
  const bool has_image = !image.empty();
  for (int i = 0; i < size; ++i) {
    const float x = points[0][i], y = points[1][i], w = points[2][i];
    const float depth = pose.Z(x, y, w), inverse_z = 1 / depth;
    const float u = px.U(pose.X(x, y, w), inverse_z);
    const float v = px.V(pose.Y(x, y, w), inverse_z);
    // Compared as numbers: far outside, an int would overflow.
    const bool inside = has_image & (depth > min_z) & px.Contains(u, v, -0.49f);
    const float column = inside ? u + 0.5f : 0.0f;
    const float row = inside ? v + 0.5f : 0.0f;
    const int at = static_cast<int>(row) * row_step +
                   static_cast<int>(column) * column_step;
    z[i] = depth;
    pixel[i] = inside ? at : -1;
  }
}

void FrameView::ReadDepth(const SightBatch& batch, Lanes* lanes) const {
  FindPixels(batch.q,
             batch.size,
             depth_from_world_,
             depth_px_,
             depth_,
             0,
             lanes->depth_z,
             lanes->depth_pixel);
  const float* depth = depth_.ptr<float>();
  for (int i = 0; i < batch.size; ++i) {
    const int pixel = lanes->depth_pixel[i];
    const float measured = pixel >= 0 ? depth[pixel] : 0.0f;
    lanes->measured[i] = std::abs(measured);
    lanes->at_depth_edge[i] = std::signbit(measured);
  }
}

// Returns whether any point is left.
bool FrameView::TestSensorDepth(int size, Lanes* lanes) const {
  const bool needs_depth =
      options_.test_sensor_depth && !options_.allow_missing_depth;
  // Without the test nothing disagrees.
  const float least = options_.test_sensor_depth
                          ? static_cast<float>(options_.min_depth_tolerance_m)
                          : std::numeric_limits<float>::infinity();
  int left = 0;
  for (int i = 0; i < size; ++i) {
    const float measured = lanes->measured[i], z = lanes->depth_z[i];
    const float tolerance = std::max(least, 3 * DepthSigma(z) + 0.02f);
    const bool missing = !(measured > 0);
    const bool disagrees = !missing & (std::abs(measured - z) > tolerance);
    int sight = static_cast<int>(Sight::kVisible);
    sight = disagrees ? static_cast<int>(Sight::kDepthDisagrees) : sight;
    sight =
        lanes->at_depth_edge[i] ? static_cast<int>(Sight::kDepthEdge) : sight;
    sight =
        missing & needs_depth ? static_cast<int>(Sight::kDepthMissing) : sight;
    const bool was_visible =
        lanes->sight[i] == static_cast<int>(Sight::kVisible);
    sight = was_visible ? sight : lanes->sight[i];
    const bool free_before = !missing & (measured < z - kFreeSpace);
    const int mild = lanes->mild[i] & !free_before;
    lanes->sight[i] = sight;
    lanes->mild[i] = mild;
    left |= mild | (sight == static_cast<int>(Sight::kVisible));
  }
  return left != 0;
}

void FrameView::ReadSurface(const SightBatch& batch, Lanes* lanes) const {
  FindPixels(batch.p,
             batch.size,
             color_from_world_,
             color_px_,
             surface_,
             kMinZ,
             lanes->surface_z,
             lanes->surface_pixel);
  const float* surface = surface_.ptr<float>();
  for (int i = 0; i < batch.size; ++i) {
    const int pixel = lanes->surface_pixel[i];
    const float nearest = pixel >= 0 ? surface[pixel] : 0.0f;
    lanes->nearest[i] = std::abs(nearest);
    lanes->farthest[i] = pixel >= 0 ? surface[pixel + 1] : kNothing;
    lanes->at_mesh_edge[i] = std::signbit(nearest);
  }
}

bool FrameView::IsOccluded(const SightBatch& batch,
                           int i,
                           const Lanes& lanes) const {
  const float z = lanes.surface_z[i];
  if (!(z > kMinZ)) return true;
  const float limit = z - static_cast<float>(options_.occlusion_tolerance_m);
  if (lanes.surface_pixel[i] >= 0) {
    if (lanes.nearest[i] >= limit) return false;
    if (lanes.farthest[i] < limit) return true;
  }
  // z grows linearly along the ray: hits with z < limit have t < limit / z.
  const Eigen::Vector3d origin = center_.cast<double>();
  const Eigen::Vector3d p(batch.p[0][i], batch.p[1][i], batch.p[2][i]);
  const double t_max = limit / z;
  return t_max > 0 && scene_.Occluded(origin, p - origin, 0, t_max);
}

void FrameView::Test(SightBatch* batch) const {
  Lanes lanes;
  const bool any_in_place = TestPlace(*batch, &lanes);
  if (any_in_place) ReadDepth(*batch, &lanes);
  const bool any_left = any_in_place && TestSensorDepth(batch->size, &lanes);
  if (any_left) ReadSurface(*batch, &lanes);
  for (int i = 0; i < batch->size; ++i) {
    Sight sight = static_cast<Sight>(lanes.sight[i]);
    bool left = any_left && (sight == Sight::kVisible || lanes.mild[i]);
    if (left && sight == Sight::kVisible && lanes.at_mesh_edge[i]) {
      sight = Sight::kMeshEdge;
      left = lanes.mild[i];
    }
    const bool occluded =
        left && options_.test_occlusion && IsOccluded(*batch, i, lanes);
    if (sight == Sight::kVisible && occluded) sight = Sight::kOccluded;
    batch->sight[i] = sight;
    batch->may_see[i] = left && !occluded;
  }
}

}  // namespace facet
