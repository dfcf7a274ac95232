// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Does a keyframe see a point of the mesh? (method, ch. 6)
//
// Occlusion: the mesh is rendered once a keyframe. A point whose depth agrees
// with all 3 x 3 pixels around it is visible, one behind all of them is hidden;
// in between - silhouettes, grazing faces - a ray to the point decides.
#pragma once

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "render/ray_scene.h"
#include "rgbd/camera.h"
#include "texture/observations.h"

namespace facet {

// The outcome for one point: the first test that fails, in this order.
enum class Sight {
  kBehindOrFar,
  kOutsideImage,
  kGrazing,
  kDepthMissing,
  kDepthEdge,
  kDepthDisagrees,
  kMeshEdge,
  kOccluded,
  kVisible,
};
inline constexpr int kNumSights = 9;

// A ball that holds a group of points, to refuse them at once.
struct Ball {
  Eigen::Vector3f center = Eigen::Vector3f::Zero();
  float radius = 0;  // [m]
};
Ball BallAround(const Eigen::Vector3f* points, size_t count);

// A keyframe prepared for visibility tests. Test() is const and may run on many
// threads.
class FrameView {
 public:
  // `depth` as from RgbdSequence::LoadDepth; may be empty when neither depth
  // test is on. `scene` must outlive the view.
  FrameView(const RgbdCalibration& calibration,
            const Pose& color_cam_from_world,
            const cv::Mat& depth,
            const RayScene& scene,
            const VisibilityOptions& options);

  // p: the point on the mesh; q: the point that is coloured (plane point);
  // normal: outward, unit.
  //
  // `may_see`, if not null, gets a milder verdict, for points that no keyframe
  // sees by the tests: inside the range and the image, not occluded by the
  // mesh, seen at less than 85 degrees, and no surface measured more than 10 cm
  // before it. Missing depth and depth edges do not matter. True for kVisible.
  Sight Test(const Eigen::Vector3f& p,
             const Eigen::Vector3f& q,
             const Eigen::Vector3f& normal,
             bool* may_see = nullptr) const;

  // The verdict on all points q of a ball, if it is the same one without
  // looking closer (kBehindOrFar or kOutsideImage); else kVisible.
  Sight TestBall(const Ball& ball) const;

  const Eigen::Vector3f& center() const { return center_; }

 private:
  // What the depth image shows of a point.
  struct DepthReading {
    float measured = 0;         // [m], 0 = missing
    float z = 0;                // of the point
    int column = -1, row = -1;  // -1 = outside the image
  };

  bool IsOccluded(const Eigen::Vector3f& p) const;
  bool IsAtMeshEdge(const Eigen::Vector3f& p) const;
  bool IsInRangeAndImage(const Eigen::Vector3f& q, Sight* refusal) const;
  DepthReading ReadDepth(const Eigen::Vector3f& q) const;
  Sight TestSensorDepth(const DepthReading& reading) const;

  // Pinhole in float: a pixel is found to 1e-3, for most of the time of a test
  // goes into this.
  struct PixelFinder {
    float fx, fy, cx, cy, right, bottom;

    explicit PixelFinder(const Pinhole& camera)
        : fx(static_cast<float>(camera.fx)),
          fy(static_cast<float>(camera.fy)),
          cx(static_cast<float>(camera.cx)),
          cy(static_cast<float>(camera.cy)),
          right(static_cast<float>(camera.width - 1)),
          bottom(static_cast<float>(camera.height - 1)) {}

    Eigen::Vector2f Project(const Eigen::Vector3f& y) const {
      const float inverse_z = 1 / y.z();
      return {fx * y.x() * inverse_z + cx, fy * y.y() * inverse_z + cy};
    }

    bool Contains(const Eigen::Vector2f& u, float margin) const {
      return u.x() >= margin && u.y() >= margin && u.x() <= right - margin &&
             u.y() <= bottom - margin;
    }
  };

  const RayScene& scene_;
  VisibilityOptions options_;
  PixelFinder color_px_, depth_px_;
  Eigen::Matrix3f rotation_, depth_rotation_;  // color / depth cam_from_world
  Eigen::Vector3f translation_, depth_translation_;
  Eigen::Vector3f center_;  // of the colour camera, world
  float min_cos_ = 0;
  float range_[2] = {};  // of z [m]
  float margin_ = 0;     // [px]
  cv::Mat depth_, edges_;
  cv::Mat mesh_edges_;
  cv::Mat nearest_, farthest_;  // 3 x 3 minimum and maximum of the z-buffer
  Eigen::Vector3f sides_[4];    // of the frustum, unit, inwards, camera frame
};

}  // namespace facet
