// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "eval/frame_alignment.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "geometry/image_sampler.h"

namespace facet {
namespace {

constexpr int kNumUnknowns = 8;  // twist, gain, bias
constexpr size_t kMinSamples = 500;
constexpr double kRadToDeg = 57.29577951308232;

using Vector8d = Eigen::Matrix<double, kNumUnknowns, 1>;
using Matrix8d = Eigen::Matrix<double, kNumUnknowns, kNumUnknowns>;

struct ModelSample {
  Eigen::Vector3d y;  // camera frame of the rendering [m]
  double luma;        // 0-1, blurred
};

struct State {
  Pose motion;  // Exp(xi) so far
  double gain = 1, bias = 0;
};

struct NormalEquations {
  Matrix8d hessian = Matrix8d::Zero();
  Vector8d gradient = Vector8d::Zero();
  double cost = 0;  // mean Huber loss of the samples that fall into the photo
  size_t count = 0;
};

cv::Mat Blur(const cv::Mat& image, double sigma) {
  cv::Mat blurred;
  cv::GaussianBlur(image, blurred, cv::Size(), sigma);
  return blurred;
}

// Luma 0-1 of the rendering, blurred over the pixels that are hit only.
cv::Mat BlurredModelLuma(const ModelView& view, double sigma) {
  cv::Mat hit;
  cv::Mat(view.depth > 0).convertTo(hit, CV_32F, 1.0 / 255);
  const cv::Mat weight = cv::max(Blur(hit, sigma), 1e-6f);
  return Blur(LumaFromColor(view.color), sigma) / weight / 255.0;
}

std::vector<ModelSample> CollectSamples(const ModelView& view,
                                        const cv::Mat& sensor_depth,
                                        const Pinhole& camera,
                                        double sigma,
                                        const AlignmentOptions& options) {
  const cv::Mat luma = BlurredModelLuma(view, sigma);
  const cv::Mat mask =
      AgreementMask(view.depth, sensor_depth, options.max_depth_difference);
  const double pixels = static_cast<double>(camera.width) * camera.height;
  const int step = std::max(
      1, static_cast<int>(std::ceil(std::sqrt(pixels / options.max_samples))));
  std::vector<ModelSample> samples;
  for (int i = 0; i < camera.height; i += step) {
    for (int j = 0; j < camera.width; j += step) {
      if (mask.at<uchar>(i, j) == 0) continue;
      samples.push_back({camera.Unproject(j, i) *
                             static_cast<double>(view.depth.at<float>(i, j)),
                         luma.at<float>(i, j)});
    }
  }
  return samples;
}

// Residual and Jacobian row of one sample; false outside the photo.
bool Linearize(const ModelSample& sample,
               const State& state,
               const Pinhole& camera,
               const ImageView<float>& photo,
               Vector8d* jacobian,
               double* residual) {
  const Eigen::Vector3d y = state.motion * sample.y;
  if (y.z() < 1e-3) return false;
  const Eigen::Vector2d pixel = camera.Project<double>(y);
  if (!camera.Contains(pixel)) return false;
  const Sample s = SampleBilinear(photo, pixel.x(), pixel.y());
  const double a = s.dx * camera.fx / y.z(), b = s.dy * camera.fy / y.z();
  const Eigen::Vector3d h(a, b, -(a * y.x() + b * y.y()) / y.z());
  *jacobian << y.cross(h), h, -sample.luma, -1.0;
  *residual = s.value - (state.gain * sample.luma + state.bias);
  return true;
}

NormalEquations Assemble(const std::vector<ModelSample>& samples,
                         const State& state,
                         const Pinhole& camera,
                         const ImageView<float>& photo,
                         double huber) {
  NormalEquations eq;
  Vector8d jacobian;
  double residual = 0;
  for (const ModelSample& sample : samples) {
    if (!Linearize(sample, state, camera, photo, &jacobian, &residual))
      continue;
    const double size = std::abs(residual);
    const double weight = size > huber ? huber / size : 1.0;
    eq.cost += size > huber ? huber * (size - 0.5 * huber) : 0.5 * size * size;
    eq.hessian.selfadjointView<Eigen::Lower>().rankUpdate(jacobian, weight);
    eq.gradient += weight * residual * jacobian;
    ++eq.count;
  }
  if (eq.count > 0) eq.cost /= static_cast<double>(eq.count);
  eq.hessian = Matrix8d(eq.hessian.selfadjointView<Eigen::Lower>());
  return eq;
}

State Step(const State& state, const NormalEquations& eq, double* length) {
  Matrix8d damped = eq.hessian;
  // Directions without texture must not blow up.
  damped.diagonal() *= 1 + 1e-6;
  damped.diagonal().array() += 1e-9 * static_cast<double>(eq.count);
  const Vector8d step = damped.ldlt().solve(-eq.gradient);
  *length = step.head<6>().norm();
  State next = state;
  next.motion = ExpSe3(Vector6d(step.head<6>())) * state.motion;
  next.gain += step[6];
  next.bias += step[7];
  return next;
}

// Gauss-Newton against one rendering; false when too few samples are left.
bool Refine(const std::vector<ModelSample>& samples,
            const Pinhole& camera,
            const ImageView<float>& photo,
            const AlignmentOptions& options,
            State* state,
            int* iterations) {
  NormalEquations eq = Assemble(samples, *state, camera, photo, options.huber);
  for (int i = 0; i < options.max_iterations; ++i) {
    if (eq.count < kMinSamples) return false;
    double length = 0;
    const State next = Step(*state, eq, &length);
    if (!std::isfinite(length)) return false;
    const NormalEquations after =
        Assemble(samples, next, camera, photo, options.huber);
    if (!(after.cost < eq.cost) || after.count < kMinSamples) break;
    *state = next;
    eq = after;
    ++*iterations;
    if (length < 5e-5) break;  // 0.05 mm, 0.003 degrees
  }
  return eq.count >= kMinSamples;
}

}  // namespace

FrameAlignment AlignFrame(const TexturedMesh& model,
                          const RayScene& scene,
                          const Pinhole& camera,
                          const Pose& cam_from_world,
                          const cv::Mat& photo,
                          const cv::Mat& sensor_depth,
                          const AlignmentOptions& options) {
  FrameAlignment result;
  result.cam_from_world = cam_from_world;
  cv::Mat photo_color;
  photo.convertTo(photo_color, CV_32F, 1.0 / 255);
  const cv::Mat photo_luma = LumaFromColor(photo_color);
  Pose pose = cam_from_world;
  State state;
  for (const double sigma : options.blur_px) {
    const ModelView view = RenderView(model, scene, camera, pose);
    const std::vector<ModelSample> samples =
        CollectSamples(view, sensor_depth, camera, sigma, options);
    const cv::Mat blurred = Blur(photo_luma, sigma);
    const ImageView<float> image{blurred.ptr<float>(),
                                 blurred.cols,
                                 blurred.rows,
                                 static_cast<ptrdiff_t>(blurred.step1())};
    state.motion = Pose();
    if (!Refine(samples, camera, image, options, &state, &result.iterations)) {
      return result;
    }
    pose = state.motion * pose;
  }
  const Pose change = pose * cam_from_world.Inverse();
  result.shift_m =
      (pose.CenterInSource() - cam_from_world.CenterInSource()).norm();
  result.angle_deg = RotationAngle(change) * kRadToDeg;
  result.accepted = result.shift_m <= options.max_shift_m &&
                    result.angle_deg <= options.max_angle_deg;
  if (result.accepted) result.cam_from_world = pose;
  return result;
}

}  // namespace facet
