// Copyright (c) 2026 The facet authors
// SPDX-License-Identifier: MIT
#include "ablate/svg_plot.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace facet {
namespace {

constexpr double kWidth = 560, kLeft = 70, kRight = 15, kTop = 34;
constexpr double kPlotHeight = 270, kLegendRow = 17;
constexpr double kPlotWidth = kWidth - kLeft - kRight;
constexpr size_t kLongestLabel = 78;

// Distinct also for colour-blind readers (Okabe and Ito).
constexpr std::array<const char*, 8> kColors = {"#0072b2",
                                                "#d55e00",
                                                "#009e73",
                                                "#cc79a7",
                                                "#e69f00",
                                                "#56b4e9",
                                                "#000000",
                                                "#a0a000"};
constexpr std::array<const char*, 3> kDashes = {"", "7 3", "2 3"};

template <typename... Args>
std::string Format(const char* format, Args... args) {
  char text[600];
  std::snprintf(text, sizeof(text), format, args...);
  return text;
}

std::string Stroke(size_t index) {
  const char* dash = kDashes[index / kColors.size() % kDashes.size()];
  return std::string("stroke=\"") + kColors[index % kColors.size()] + "\"" +
         (*dash ? std::string(" stroke-dasharray=\"") + dash + "\"" : "");
}

std::string Shorten(const std::string& label) {
  return label.size() <= kLongestLabel
             ? label
             : label.substr(0, kLongestLabel - 3) + "...";
}

// One axis: data to the unit interval.
struct Scale {
  double low = 0, high = 1;
  bool log = false;
  std::vector<double> ticks;

  double At(double value) const {
    if (log) {
      return (std::log10(value) - std::log10(low)) /
             (std::log10(high) - std::log10(low));
    }
    return (value - low) / (high - low);
  }
};

Scale LinearScale(double low, double high) {
  if (!(high > low)) {
    const double half = low == 0 ? 1 : 0.1 * std::abs(low);
    low -= half;
    high += half;
  }
  Scale scale;
  scale.ticks = NiceTicks(low, high, 6);
  const double margin = 0.03 * (high - low);
  scale.low = low - margin;
  scale.high = high + margin;
  return scale;
}

Scale LogScale(double low, double high) {
  Scale scale;
  scale.log = true;
  const int first = static_cast<int>(std::floor(std::log10(low) + 1e-9));
  const int last =
      std::max(first + 1, static_cast<int>(std::ceil(std::log10(high) - 1e-9)));
  for (int e = first; e <= last; ++e) scale.ticks.push_back(std::pow(10.0, e));
  scale.low = scale.ticks.front();
  scale.high = scale.ticks.back();
  return scale;
}

class Drawing {
 public:
  explicit Drawing(const Plot& plot) : plot_(plot) {
    double x_low = 1e300, x_high = -1e300, y_low = 1e300, y_high = -1e300;
    for (const PlotLine& line : plot.lines) {
      for (size_t i = 0; i < line.x.size(); ++i) {
        if (!Drawn(line.y[i])) continue;
        x_low = std::min(x_low, line.x[i]);
        x_high = std::max(x_high, line.x[i]);
        y_low = std::min(y_low, line.y[i]);
        y_high = std::max(y_high, line.y[i]);
      }
    }
    if (std::isfinite(plot.level) && Drawn(plot.level)) {
      y_low = std::min(y_low, plot.level);
      y_high = std::max(y_high, plot.level);
    }
    empty_ = x_low > x_high;
    if (empty_) {
      x_low = y_low = 1;
      x_high = y_high = 2;
    }
    x_ = LinearScale(plot.x_from_zero ? std::min(0.0, x_low) : x_low, x_high);
    y_ = plot.log_y ? LogScale(y_low, y_high) : LinearScale(y_low, y_high);
  }

  std::string Draw() {
    const double height = kTop + kPlotHeight + 50 +
                          kLegendRow * static_cast<double>(plot_.lines.size());
    text_ = Format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%g\" height=\"%g\" "
        "viewBox=\"0 0 %g %g\" font-family=\"sans-serif\" font-size=\"12\">\n"
        "<rect width=\"100%%\" height=\"100%%\" fill=\"white\"/>\n",
        kWidth,
        height,
        kWidth,
        height);
    text_ += Format(
                 "<text x=\"%g\" y=\"20\" font-size=\"14\" "
                 "font-weight=\"bold\" text-anchor=\"middle\">",
                 kLeft + kPlotWidth / 2) +
             EscapeXml(plot_.title) + "</text>\n";
    DrawAxes();
    if (empty_) {
      Label(kLeft + kPlotWidth / 2,
            kTop + kPlotHeight / 2,
            "middle",
            "nothing to draw");
    }
    DrawLevel();
    for (const PlotLine& line : plot_.lines) DrawLine(line);
    DrawLegend();
    return text_ + "</svg>\n";
  }

 private:
  bool Drawn(double y) const { return !plot_.log_y || y > 0; }
  double X(double x) const { return kLeft + kPlotWidth * x_.At(x); }
  double Y(double y) const { return kTop + kPlotHeight * (1 - y_.At(y)); }

  void Segment(double x1, double y1, double x2, double y2, const char* style) {
    text_ += Format(
        "<line x1=\"%.1f\" y1=\"%.1f\" x2=\"%.1f\" y2=\"%.1f\" %s/>"
        "\n",
        x1,
        y1,
        x2,
        y2,
        style);
  }
  void Label(double x, double y, const char* anchor, const std::string& label) {
    text_ +=
        Format(
            "<text x=\"%.1f\" y=\"%.1f\" text-anchor=\"%s\">", x, y, anchor) +
        EscapeXml(label) + "</text>\n";
  }

  void DrawAxes() {
    const double bottom = kTop + kPlotHeight, right = kLeft + kPlotWidth;
    const char* grid = "stroke=\"#dddddd\"";
    for (const double tick : x_.ticks) {
      Segment(X(tick), kTop, X(tick), bottom, grid);
      Label(X(tick), bottom + 16, "middle", Format("%g", tick));
    }
    for (const double tick : y_.ticks) {
      Segment(kLeft, Y(tick), right, Y(tick), grid);
      Label(kLeft - 6, Y(tick) + 4, "end", Format("%g", tick));
    }
    text_ += Format(
        "<rect x=\"%g\" y=\"%g\" width=\"%g\" height=\"%g\" "
        "fill=\"none\" stroke=\"#444444\"/>\n",
        kLeft,
        kTop,
        kPlotWidth,
        kPlotHeight);
    Label(kLeft + kPlotWidth / 2, bottom + 34, "middle", plot_.x_label);
    const double middle = kTop + kPlotHeight / 2;
    text_ += Format(
                 "<text x=\"14\" y=\"%g\" text-anchor=\"middle\" "
                 "transform=\"rotate(-90 14 %g)\">",
                 middle,
                 middle) +
             EscapeXml(plot_.y_label) + "</text>\n";
  }

  void DrawLevel() {
    if (!std::isfinite(plot_.level) || !Drawn(plot_.level)) return;
    const double y = Y(plot_.level);
    Segment(kLeft,
            y,
            kLeft + kPlotWidth,
            y,
            "stroke=\"#888888\" stroke-dasharray=\"4 4\"");
    Label(kLeft + kPlotWidth - 4, y - 4, "end", plot_.level_label);
  }

  void DrawLine(const PlotLine& line) {
    const std::string stroke = Stroke(line.index);
    text_ +=
        "<polyline fill=\"none\" stroke-width=\"1.8\" " + stroke + " points=\"";
    for (size_t i = 0; i < line.x.size(); ++i) {
      if (!Drawn(line.y[i])) continue;
      text_ += Format("%.1f,%.1f ", X(line.x[i]), Y(line.y[i]));
    }
    text_ += "\"/>\n";
    if (!line.markers) return;
    for (size_t i = 0; i < line.x.size(); ++i) {
      if (!Drawn(line.y[i])) continue;
      text_ += Format(
          "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"2.2\" fill=\"%s\"/>"
          "\n",
          X(line.x[i]),
          Y(line.y[i]),
          kColors[line.index % kColors.size()]);
    }
  }

  void DrawLegend() {
    double y = kTop + kPlotHeight + 56;
    for (const PlotLine& line : plot_.lines) {
      Segment(kLeft,
              y - 4,
              kLeft + 26,
              y - 4,
              ("stroke-width=\"2.5\" " + Stroke(line.index)).c_str());
      Label(kLeft + 33, y, "start", Shorten(line.label));
      y += kLegendRow;
    }
  }

  const Plot& plot_;
  Scale x_, y_;
  bool empty_ = false;
  std::string text_;
};

}  // namespace

std::string EscapeXml(const std::string& text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      case '"':
        escaped += "&quot;";
        break;
      default:
        escaped += c;
    }
  }
  return escaped;
}

std::vector<double> NiceTicks(double low, double high, int count) {
  const double raw = (high - low) / count;
  const double decade = std::pow(10.0, std::floor(std::log10(raw)));
  double step = 10 * decade;
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * decade >= raw) {
      step = factor * decade;
      break;
    }
  }
  std::vector<double> ticks;
  const double first = std::ceil(low / step - 1e-9);
  for (double k = first; k * step <= high + 1e-9 * step; ++k) {
    ticks.push_back(k == 0 ? 0.0 : k * step);
  }
  return ticks;
}

std::string DrawSvg(const Plot& plot) { return Drawing(plot).Draw(); }

}  // namespace facet
