// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// A scan of a few small frames on disk, in the BundleFusion layout. Tests write
// it whole and then damage what they are about.
#pragma once

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "geometry/pose.h"
#include "rgbd/sequence.h"
#include "tests/support/temp_dir.h"

namespace facet {

class TinySequence {
 public:
  // Colour 40x30 and depth 32x24: two cameras, 3 cm apart and turned.
  explicit TinySequence(const std::vector<int>& numbers = {0, 1, 2}) {
    WriteInfo("info.txt");
    for (const int number : numbers) WriteFrame(number);
  }

  std::string path() const { return dir_.path(); }
  std::string operator/(const std::string& name) const { return dir_ / name; }

  static Pose ColorExtrinsic() {
    return ExpSe3(
        (Vector6d() << 0.01, -0.02, 0.03, -0.03, 0.002, 0.001).finished());
  }
  static Pose DepthExtrinsic() {
    return ExpSe3((Vector6d() << 0.02, 0.01, 0, 0.001, 0, 0).finished());
  }
  static Pose WorldFromCam(int number) {
    return ExpSe3((Vector6d() << 0.1 * number,
                   0.2,
                   -0.05 * number,
                   0.3,
                   0.01 * number,
                   1.0)
                      .finished());
  }

  std::string FrameFile(int number, const std::string& rest) const {
    char name[32];
    std::snprintf(name, sizeof(name), "frame-%06d.", number);
    return dir_ / (name + rest);
  }

  void Write(const std::string& name, const std::string& text) const {
    std::ofstream(dir_ / name) << text;
  }
  void Remove(const std::string& file) const { std::filesystem::remove(file); }
  // Cuts a file to the given share of its bytes.
  void Truncate(const std::string& file, double share) const {
    std::filesystem::resize_file(
        file, static_cast<size_t>(share * std::filesystem::file_size(file)));
  }

  static std::string MatrixText(const Eigen::Matrix4d& m) {
    std::ostringstream text;
    text.precision(9);
    for (int i = 0; i < 16; ++i) {
      text << m(i / 4, i % 4) << (i % 4 == 3 ? '\n' : ' ');
    }
    return text.str();
  }

  void WritePose(int number, const Eigen::Matrix4d& m) const {
    std::ofstream(FrameFile(number, "pose.txt")) << MatrixText(m);
  }

  void WriteInfo(const std::string& name,
                 const std::string& without_key = "") const {
    std::string text;
    const auto add = [&](const std::string& key, std::string value) {
      if (key == without_key) return;
      for (char& c : value) c = c == '\n' ? ' ' : c;
      text += key + " = " + value + "\n";
    };
    add("m_versionNumber", "4");
    add("m_sensorName", "a sensor with blanks = and signs");
    add("m_colorWidth", "40");
    add("m_colorHeight", "30");
    add("m_depthWidth", "32");
    add("m_depthHeight", "24");
    add("m_depthShift", "1000");
    add("m_calibrationColorIntrinsic",
        "35 0 19.5 0 0 36 14.5 0 0 0 1 0 0 0 0 1");
    add("m_calibrationDepthIntrinsic",
        "30 0 15.5 0 0 31 11.5 0 0 0 1 0 0 0 0 1");
    add("m_calibrationColorExtrinsic", MatrixText(ColorExtrinsic().Matrix()));
    add("m_calibrationDepthExtrinsic", MatrixText(DepthExtrinsic().Matrix()));
    add("m_frames.size", "12345");
    Write(name, text);
  }

  // A red colour image and a depth of 1500 + number millimetres.
  void WriteFrame(int number) const {
    cv::imwrite(FrameFile(number, "color.jpg"),
                cv::Mat(30, 40, CV_8UC3, cv::Scalar(10, 60, 200)));
    cv::imwrite(FrameFile(number, "depth.png"),
                cv::Mat(24, 32, CV_16U, cv::Scalar(1500 + number)));
    WritePose(number, WorldFromCam(number).Matrix());
  }

  // A random texture, blurred, as the colour image of a frame.
  void WriteTexture(int number, double blur_sigma) const {
    cv::Mat image(30, 40, CV_8UC3);
    cv::RNG random(7);
    random.fill(image, cv::RNG::UNIFORM, 0, 256);
    if (blur_sigma > 0) cv::GaussianBlur(image, image, {0, 0}, blur_sigma);
    cv::imwrite(FrameFile(number, "color.png"), image);
    Remove(FrameFile(number, "color.jpg"));
  }

 private:
  TempDir dir_;
};

}  // namespace facet
