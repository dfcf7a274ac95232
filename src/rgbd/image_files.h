// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Decoding of the two kinds of images a scan consists of. Stored pixels are
// taken as they lie: no rotation by EXIF, no gamma.
#pragma once

#include <opencv2/core.hpp>
#include <string>

namespace facet {

// JPEG or PNG as CV_8UC3 in RGB order, any size. Throws InputError naming the
// file: missing, not an image, truncated.
cv::Mat ReadColorImage(const std::string& path);

// Its luma as CV_8UC1, of a JPEG without decoding the colours.
cv::Mat ReadLumaImage(const std::string& path);

// 16-bit grey PNG or PGM (big-endian) as CV_16U, any size. Throws InputError
// naming the file: missing, not an image, truncated, not 16-bit grey.
cv::Mat ReadRawDepthImage(const std::string& path);

// raw / depth_shift as CV_32F [m]; raw 0, raw 65535 and what lies outside
// [min_depth_m, max_depth_m] become 0 = missing (method, Sec. 1.1).
cv::Mat DepthInMetres(const cv::Mat& raw,
                      double depth_shift,
                      double min_depth_m,
                      double max_depth_m);

}  // namespace facet
