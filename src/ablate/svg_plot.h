// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Line plots as SVG text, complete in themselves: axes with ticks and units,
// grid, legend.
#pragma once

#include <limits>
#include <string>
#include <vector>

namespace facet {

struct PlotLine {
  std::string label;
  // Colour and dash: lines of one index look the same in all plots.
  size_t index = 0;
  std::vector<double> x, y;  // finite
  bool markers = false;      // dots at the points
};

struct Plot {
  std::string title, x_label, y_label;
  bool x_from_zero = true;  // as times and iterations begin
  bool log_y = false;       // points with y <= 0 are left out
  // Where finite: a dashed horizontal line, and what it means.
  double level = std::numeric_limits<double>::quiet_NaN();
  std::string level_label;
  std::vector<PlotLine> lines;
};

// 560 px wide; as high as the legend needs.
std::string DrawSvg(const Plot& plot);

// For text between tags and in attributes of SVG and HTML.
std::string EscapeXml(const std::string& text);

// Round numbers that span [low, high], about `count` of them.
std::vector<double> NiceTicks(double low, double high, int count);

}  // namespace facet
