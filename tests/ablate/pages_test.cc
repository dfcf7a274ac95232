// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
//
// Plots and the page: structure that a browser relies on.
#include <gtest/gtest.h>

#include <cmath>

#include "ablate/html_page.h"
#include "ablate/plots.h"
#include "ablate/svg_plot.h"

namespace facet {
namespace {

std::string Encode(const std::string& text) {
  return Base64({text.begin(), text.end()});
}

// The examples of RFC 4648.
TEST(Pages, Base64) {
  EXPECT_EQ(Encode(""), "");
  EXPECT_EQ(Encode("f"), "Zg==");
  EXPECT_EQ(Encode("fo"), "Zm8=");
  EXPECT_EQ(Encode("foo"), "Zm9v");
  EXPECT_EQ(Encode("foobar"), "Zm9vYmFy");
}

TEST(Pages, TicksAreRoundAndSpanTheRange) {
  for (const auto& [low, high] : std::vector<std::pair<double, double>>{
           {0, 1}, {0.013, 0.0172}, {-5, 123456}, {3, 3.00001}}) {
    const std::vector<double> ticks = NiceTicks(low, high, 6);
    ASSERT_GE(ticks.size(), 2u);
    EXPECT_LE(ticks.size(), 8u);
    for (size_t i = 1; i < ticks.size(); ++i) {
      const double step = ticks[i] - ticks[i - 1];
      const double digit =
          step / std::pow(10, std::floor(std::log10(step) + 1e-6));
      EXPECT_LT(
          std::min(
              {std::abs(digit - 1), std::abs(digit - 2), std::abs(digit - 5)}),
          1e-4)
          << step;
      EXPECT_GE(ticks[i], low);
      EXPECT_LE(ticks[i], high + 1e-6 * step);
    }
  }
}

// All points lie inside the frame, labels are escaped, tags are closed.
TEST(Pages, SvgIsCompleteAndInsideItsFrame) {
  Plot plot;
  plot.title = "a < b";
  plot.x_label = "t [s]";
  plot.y_label = "\"E\"";
  PlotLine line;
  line.label = "x & y";
  line.markers = true;
  line.x = {0, 1, 5};
  line.y = {1, 0.1, 0};
  plot.lines = {line};
  for (const bool log_y : {false, true}) {
    plot.log_y = log_y;
    const std::string svg = DrawSvg(plot);
    EXPECT_EQ(svg.find("nan"), std::string::npos);
    EXPECT_EQ(svg.find("inf"), std::string::npos);
    EXPECT_NE(svg.find("a &lt; b"), std::string::npos);
    EXPECT_NE(svg.find("x &amp; y"), std::string::npos);
    EXPECT_EQ(svg.substr(svg.size() - 7), "</svg>\n");
    size_t circles = 0;
    for (size_t at = svg.find("<circle"); at != std::string::npos;
         at = svg.find("<circle", at + 1)) {
      double x = 0, y = 0;
      ASSERT_EQ(std::sscanf(
                    svg.c_str() + at, "<circle cx=\"%lf\" cy=\"%lf\"", &x, &y),
                2);
      EXPECT_GE(x, 70);
      EXPECT_LE(x, 545);
      EXPECT_GE(y, 34);
      EXPECT_LE(y, 304);
      ++circles;
    }
    EXPECT_EQ(circles, log_y ? 2u : 3u) << "0 has no logarithm";
  }
  EXPECT_NE(DrawSvg(Plot()).find("nothing to draw"), std::string::npos);
}

// The mean keeps the value of a curve that has ended, and is exact at every
// point of every curve.
TEST(Pages, MeanCurve) {
  const Curve a = {{0, 2}, {1, 0}};
  const Curve b = {{0, 1, 4}, {1, 0.5, 0.5}};
  const Curve mean = MeanCurve({a, b});
  ASSERT_EQ(mean.x, (std::vector<double>{0, 1, 2, 4}));
  EXPECT_DOUBLE_EQ(mean.y[0], 1);
  EXPECT_DOUBLE_EQ(mean.y[1], 0.5);
  EXPECT_DOUBLE_EQ(mean.y[2], 0.25);
  EXPECT_DOUBLE_EQ(mean.y[3], 0.25);
  const Curve twice = MeanCurve({a, a});
  for (size_t i = 0; i < a.x.size(); ++i) EXPECT_EQ(twice.y[i], a.y[i]);
}

}  // namespace
}  // namespace facet
