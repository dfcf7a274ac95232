// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "eval/photometric_metrics.h"

#include <gtest/gtest.h>

#include "eval/frame_alignment.h"
#include "tests/eval/eval_scene.h"

namespace facet {
namespace {

class PhotometricMetrics : public ::testing::Test {
 protected:
  ModelView Render(const TexturedMesh& model, const Pose& pose = Pose()) const {
    return RenderView(model, RayScene(model.mesh), camera_, pose);
  }
  Pinhole camera_ = SmallCamera();
  TexturedMesh model_ = Corner();
  ModelView view_ = Render(model_);
};

// A wrong mask, normalisation or channel order would show: a picture agrees
// with itself perfectly, and no figure may be infinite.
TEST_F(PhotometricMetrics, IdenticalPicturesArePerfect) {
  ModelView rounded{cv::Mat(), view_.depth};
  AsPhoto(view_).convertTo(rounded.color, CV_32F);
  const ViewMetrics m = CompareView(rounded, AsPhoto(view_), view_.depth, 0.05);
  EXPECT_EQ(m.psnr, kMaxPsnr);
  EXPECT_EQ(m.psnr_strict, kMaxPsnr);
  EXPECT_GT(m.psnr_affine, 80);  // the fit rounds
  EXPECT_NEAR(m.ssim, 1, 1e-6);
  EXPECT_NEAR(m.gradient_ncc, 1, 1e-9);
  EXPECT_NEAR(m.gradient_energy, 1, 1e-9);
  EXPECT_EQ(m.coverage, 1);
  EXPECT_EQ(m.agreement, 1);
  EXPECT_EQ(m.depth_error_mean, 0);
}

// The error of a constant difference d is exactly 20 log10(255 / d).
TEST_F(PhotometricMetrics, PsnrOfAConstantDifference) {
  const cv::Mat a(20, 30, CV_32FC3, cv::Scalar::all(100));
  const cv::Mat b(20, 30, CV_32FC3, cv::Scalar::all(105));
  const cv::Mat mask(20, 30, CV_8U, cv::Scalar(255));
  EXPECT_NEAR(MaskedPsnr(a, b, mask), 20 * std::log10(255.0 / 5), 1e-9);
  EXPECT_TRUE(std::isnan(MaskedPsnr(a, b, cv::Mat::zeros(20, 30, CV_8U))));
}

// Fitting all channels together, or photo to model, would miss these.
TEST_F(PhotometricMetrics, AffineRemovesGainAndBiasOfEachChannel) {
  cv::Mat photo(view_.color.size(), CV_8UC3);
  for (int i = 0; i < photo.rows; ++i) {
    for (int j = 0; j < photo.cols; ++j) {
      const cv::Vec3f c = view_.color.at<cv::Vec3f>(i, j);
      photo.at<cv::Vec3b>(i, j) =
          cv::Vec3b(cv::saturate_cast<uchar>(0.6 * c[0] + 40),
                    cv::saturate_cast<uchar>(0.8 * c[1] + 10),
                    cv::saturate_cast<uchar>(0.5 * c[2] + 90));
    }
  }
  const ViewMetrics m = CompareView(view_, photo, view_.depth, 0.05);
  EXPECT_LT(m.psnr, 25);
  EXPECT_GT(m.psnr_affine, 55);  // rounding to 8 bits alone costs 58.9 dB
  EXPECT_GT(m.ssim_affine, m.ssim);
  cv::Mat photo_color;
  photo.convertTo(photo_color, CV_32F);
  const AffineColor fit =
      FitAffineColor(view_.color, photo_color, view_.depth > 0);
  EXPECT_NEAR(fit.gain[0], 0.6, 1e-3);
  EXPECT_NEAR(fit.gain[1], 0.8, 1e-3);
  EXPECT_NEAR(fit.gain[2], 0.5, 1e-3);
  EXPECT_NEAR(fit.bias[2], 90, 0.1);
}

// Without the trimming round a highlight on 2 % of the pixels would bend the
// fit: the residuals of the other pixels would not be those of rounding.
TEST_F(PhotometricMetrics, AffineTrimsOutliers) {
  cv::Mat photo = view_.color.clone();
  photo(cv::Rect(60, 50, 24, 16)).setTo(cv::Scalar::all(2000));
  const AffineColor fit = FitAffineColor(view_.color, photo, view_.depth > 0);
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(fit.gain[c], 1, 1e-6);
    EXPECT_NEAR(fit.bias[c], 0, 1e-3);
  }
}

// PSNR alone rewards blur; the gradients must not.
TEST_F(PhotometricMetrics, BlurLowersGradientEnergy) {
  ModelView blurred{cv::Mat(), view_.depth};
  cv::GaussianBlur(view_.color, blurred.color, {0, 0}, 3);
  const ViewMetrics m = CompareView(blurred, AsPhoto(view_), view_.depth, 0.05);
  EXPECT_LT(m.gradient_energy, 0.6);
  EXPECT_LT(m.gradient_ncc, 0.95);
  EXPECT_GT(m.gradient_ncc, 0.3);
}

// A model that lacks a wall must not win by it: strict counts the hole, plain
// does not.
TEST_F(PhotometricMetrics, HolesCountInStrictAndCoverage) {
  TexturedMesh part = model_;
  part.mesh.faces.resize(2);  // the back wall alone, seen through the others
  part.face_uv.resize(2);
  part.face_page.resize(2);
  const Pose aside(
      Eigen::Quaterniond(Eigen::AngleAxisd(-0.6, Eigen::Vector3d::UnitY())),
      Eigen::Vector3d::Zero());
  const ModelView whole = Render(model_, aside);
  const ViewMetrics m =
      CompareView(Render(part, aside), AsPhoto(whole), whole.depth, 0.05);
  EXPECT_GT(m.psnr, m.psnr_strict + 10);
  EXPECT_LT(m.agreement, 0.9);
  EXPECT_LE(m.agreement, m.coverage);
}

// Neither SSIM nor gradients may look at what lies outside the mask.
TEST_F(PhotometricMetrics, OutsideOfTheMaskDoesNotMatter) {
  cv::Mat mask = cv::Mat::zeros(view_.depth.size(), CV_8U);
  mask(cv::Rect(30, 30, 60, 50)).setTo(255);
  const cv::Mat luma = LumaFromColor(view_.color);
  cv::Mat other = luma.clone();
  other.setTo(255, mask == 0);
  EXPECT_NEAR(MaskedSsim(luma, other, mask), 1, 1e-5);
  const GradientAgreement g = CompareGradients(other, luma, mask);
  EXPECT_NEAR(g.ncc, 1, 1e-9);
  EXPECT_NEAR(g.energy, 1, 1e-9);
}

// A surface 10 cm off is another surface; missing sensor depth says nothing.
TEST_F(PhotometricMetrics, MaskNeedsTheSensorDepth) {
  cv::Mat depth = view_.depth.clone();
  depth.colRange(0, 40) += 0.1f;
  depth.colRange(40, 80) = 0;
  const cv::Mat mask = AgreementMask(view_.depth, depth, 0.05);
  EXPECT_EQ(cv::countNonZero(mask.colRange(0, 80)), 0);
  EXPECT_EQ(cv::countNonZero(mask), 80 * 120);
  const ViewMetrics m = CompareView(view_, AsPhoto(view_), depth, 0.05);
  EXPECT_NEAR(m.agreement, 2.0 / 3, 1e-9);
  EXPECT_EQ(m.coverage, 1);
}

// The sign of any of the six derivatives being wrong, or gain and bias of the
// photo being taken for motion, would break it.
TEST_F(PhotometricMetrics, AlignmentRecoversAPoseOffset) {
  const RayScene scene(model_.mesh);
  const Pose truth =
      ExpSe3((Vector6d() << 0.05, -0.1, 0.02, 0.1, -0.05, 0.03).finished());
  const ModelView at_truth = RenderView(model_, scene, camera_, truth);
  cv::Mat photo;
  at_truth.color.convertTo(photo, CV_8U, 0.9, 8);
  for (int axis = 0; axis < 6; ++axis) {
    Vector6d offset = Vector6d::Zero();
    offset[axis] = axis < 3 ? 0.005 : 0.005;  // 0.3 degrees, 5 mm
    const Pose start = ExpSe3(offset) * truth;
    const FrameAlignment found = AlignFrame(model_,
                                            scene,
                                            camera_,
                                            start,
                                            photo,
                                            at_truth.depth,
                                            AlignmentOptions());
    ASSERT_TRUE(found.accepted);
    const Pose error = found.cam_from_world * truth.Inverse();
    EXPECT_LT(error.translation.norm(), 0.0005) << axis;
    EXPECT_LT(RotationAngle(error), 0.0005) << axis;
    const ViewMetrics given = CompareView(
        RenderView(model_, scene, camera_, start), photo, at_truth.depth, 0.05);
    const ViewMetrics aligned =
        CompareView(RenderView(model_, scene, camera_, found.cam_from_world),
                    photo,
                    at_truth.depth,
                    0.05);
    EXPECT_GT(aligned.psnr_affine, given.psnr_affine);
    EXPECT_GT(aligned.gradient_ncc, given.gradient_ncc);
  }
}

// Too far means not accepted, and the given pose comes back.
TEST_F(PhotometricMetrics, AlignmentRejectsLargeMotion) {
  const RayScene scene(model_.mesh);
  Vector6d offset = Vector6d::Zero();
  offset[3] = 0.02;
  const Pose start = ExpSe3(offset);
  AlignmentOptions options;
  options.max_shift_m = 0.01;
  const FrameAlignment found = AlignFrame(
      model_, scene, camera_, start, AsPhoto(view_), view_.depth, options);
  EXPECT_FALSE(found.accepted);
  EXPECT_NEAR(found.shift_m, 0.02, 0.002);
  EXPECT_EQ(found.cam_from_world.translation, start.translation);
  // Nothing to align to.
  const FrameAlignment blind =
      AlignFrame(model_,
                 scene,
                 camera_,
                 start,
                 AsPhoto(view_),
                 cv::Mat::zeros(view_.depth.size(), CV_32F),
                 AlignmentOptions());
  EXPECT_FALSE(blind.accepted);
}

}  // namespace
}  // namespace facet
