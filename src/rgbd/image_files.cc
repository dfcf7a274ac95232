// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "rgbd/image_files.h"

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "util/atomic_file.h"
#include "util/errors.h"

namespace facet {
namespace {

// libjpeg fills what is missing of a truncated file with grey and only warns;
// a frame that is half grey must not pass for a picture. The end marker cannot
// occur inside the compressed data; a preview at the head of the file has one
// of its own, hence the second half.
bool IsTruncatedJpeg(const std::string& bytes) {
  if (bytes.compare(0, 2, "\xff\xd8") != 0) return false;
  const size_t end = bytes.rfind("\xff\xd9");
  return end == std::string::npos || end < bytes.size() / 2;
}

cv::Mat Decode(const std::string& path, int flags) {
  const std::string bytes = ReadFile(path);
  cv::Mat image;
  if (!bytes.empty() && !IsTruncatedJpeg(bytes)) {
    try {
      const cv::Mat buffer(1,
                           static_cast<int>(bytes.size()),
                           CV_8U,
                           const_cast<char*>(bytes.data()));
      image = cv::imdecode(buffer, flags);
    } catch (const cv::Exception&) {
      image.release();  // e.g. a header that asks for an absurd size
    }
  }
  if (image.empty()) {
    throw InputError("image '" + path +
                     "' does not decode: it is truncated, damaged or of an "
                     "unknown type; copy it again or delete the frame");
  }
  return image;
}

}  // namespace

cv::Mat ReadColorImage(const std::string& path) {
  const cv::Mat bgr =
      Decode(path, cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION);
  cv::Mat rgb;
  cv::cvtColor(bgr, rgb, cv::COLOR_BGR2RGB);
  return rgb;
}

cv::Mat ReadLumaImage(const std::string& path) {
  return Decode(path, cv::IMREAD_GRAYSCALE | cv::IMREAD_IGNORE_ORIENTATION);
}

cv::Mat ReadRawDepthImage(const std::string& path) {
  cv::Mat raw = Decode(path, cv::IMREAD_UNCHANGED);
  if (raw.type() != CV_16UC1) {
    throw InputError("depth image '" + path +
                     "' is not a single channel of 16 bits: export the raw "
                     "sensor depth, not a picture of it");
  }
  return raw;
}

cv::Mat DepthInMetres(const cv::Mat& raw,
                      double depth_shift,
                      double min_depth_m,
                      double max_depth_m) {
  cv::Mat depth(raw.size(), CV_32F);
  const double metres = 1.0 / depth_shift;
  for (int y = 0; y < raw.rows; ++y) {
    const uint16_t* in = raw.ptr<uint16_t>(y);
    float* out = depth.ptr<float>(y);
    for (int x = 0; x < raw.cols; ++x) {
      const double z = in[x] * metres;
      const bool valid =
          in[x] != 0 && in[x] != 65535 && z >= min_depth_m && z <= max_depth_m;
      out[x] = valid ? static_cast<float>(z) : 0.0f;
    }
  }
  return depth;
}

}  // namespace facet
