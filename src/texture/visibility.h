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
#include <vector>

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

// Up to kCapacity points with one normal, and what FrameView::Test says of
// them.
struct SightBatch {
  static constexpr int kCapacity = 64;

  int size = 0;
  const float *p[3], *q[3];  // as in SightPoints
  Eigen::Vector3f normal;    // outward, unit

  Sight sight[kCapacity];
  bool may_see[kCapacity];
};

// Points to be tested, in arrays that the compiler can vectorise over: p on the
// mesh, and q that is coloured (the plane point).
class SightPoints {
 public:
  explicit SightPoints(size_t size) : size_(size), rows_(6 * size) {}

  void Set(size_t i, const Eigen::Vector3f& p, const Eigen::Vector3f& q) {
    for (size_t k = 0; k < 3; ++k) {
      rows_[k * size_ + i] = p[static_cast<int>(k)];
      rows_[(3 + k) * size_ + i] = q[static_cast<int>(k)];
    }
  }

  // Those of [begin, end).
  SightBatch Batch(size_t begin,
                   size_t end,
                   const Eigen::Vector3f& normal) const {
    SightBatch batch;
    batch.size = static_cast<int>(end - begin);
    for (size_t k = 0; k < 3; ++k) {
      batch.p[k] = rows_.data() + k * size_ + begin;
      batch.q[k] = rows_.data() + (3 + k) * size_ + begin;
    }
    batch.normal = normal;
    return batch;
  }

 private:
  size_t size_;
  std::vector<float> rows_;
};

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

  // Sets the verdicts on the points of a batch.
  //
  // `may_see` is a milder one, for points that no keyframe sees by the tests:
  // inside the range and the image, not occluded by the mesh, seen at less than
  // 85 degrees, and no surface measured more than 10 cm before it. Missing
  // depth and depth edges do not matter. True for kVisible.
  void Test(SightBatch* batch) const;

  // The verdict on all points q of a ball, if it is the same one without
  // looking closer (kBehindOrFar or kOutsideImage); else kVisible.
  Sight TestBall(const Ball& ball) const;

  const Eigen::Vector3f& center() const { return center_; }

 private:
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

    float U(float x, float inverse_z) const { return fx * x * inverse_z + cx; }
    float V(float y, float inverse_z) const { return fy * y * inverse_z + cy; }

    bool Contains(float u, float v, float margin) const {
      return (u >= margin) & (v >= margin) & (u <= right - margin) &
             (v <= bottom - margin);
    }
  };

  // cam_from_world in float.
  struct FloatPose {
    float r[9], t[3];

    explicit FloatPose(const Pose& pose) {
      const Eigen::Matrix3d rotation = pose.RotationMatrix();
      for (int k = 0; k < 9; ++k) {
        r[k] = static_cast<float>(rotation(k / 3, k % 3));
      }
      for (int k = 0; k < 3; ++k) {
        t[k] = static_cast<float>(pose.translation[k]);
      }
    }

    float X(float x, float y, float z) const {
      return r[0] * x + r[1] * y + r[2] * z + t[0];
    }
    float Y(float x, float y, float z) const {
      return r[3] * x + r[4] * y + r[5] * z + t[1];
    }
    float Z(float x, float y, float z) const {
      return r[6] * x + r[7] * y + r[8] * z + t[2];
    }
  };

  struct Lanes;

  void ReadMesh(const RayScene& scene,
                const Pinhole& color,
                const Pose& color_cam_from_world);
  // Depths of points and the places of their nearest pixels in an image of
  // floats, -1 outside of it and before min_z.
  static void FindPixels(const float* const points[3],
                         int size,
                         const FloatPose& pose,
                         const PixelFinder& px,
                         const cv::Mat& image,
                         float min_z,
                         float* z,
                         int* pixel);
  // The steps of Test(), on all points of a batch.
  bool TestPlace(const SightBatch& batch, Lanes* lanes) const;
  void ReadDepth(const SightBatch& batch, Lanes* lanes) const;
  bool TestSensorDepth(int size, Lanes* lanes) const;
  void ReadSurface(const SightBatch& batch, Lanes* lanes) const;
  bool IsOccluded(const SightBatch& batch, int i, const Lanes& lanes) const;

  const RayScene& scene_;
  VisibilityOptions options_;
  PixelFinder color_px_, depth_px_;
  FloatPose color_from_world_, depth_from_world_;
  Eigen::Vector3f center_;  // of the colour camera, world
  float min_cos_ = 0;
  float range_[2] = {};  // of z [m]
  float margin_ = 0;     // [px]
  // A pixel is read at once: negative where it is an edge.
  cv::Mat depth_;             // CV_32F [m]
  cv::Mat surface_;           // CV_32FC2: nearest and farthest z [m]
  Eigen::Vector3f sides_[4];  // of the frustum, unit, inwards, camera frame
};

}  // namespace facet
